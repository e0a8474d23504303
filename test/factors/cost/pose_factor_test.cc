#include "factors/cost/pose_factor.h"

#include <gtest/gtest.h>

#include "factors/spline/spline.h"
#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

class PoseFactorTest : public testing::Test {
 protected:
  PoseFactorTest() {
    blocks_.AddSpline(4, 0.3, &random_);
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) measurement_.root(i, j) = random_.Uniform(-2.0, 2.0);
      measurement_.offset[i] = random_.Uniform(-1.0, 1.0);
    }
  }

  SplinePose PoseAt(double u) {
    const std::vector<const double*> data = blocks_.pointers();
    return EvaluatePose(data.data(), data.data() + 4, u, nullptr);
  }

  TestRandom random_{11};
  TestBlocks blocks_;
  PoseMeasurement measurement_;
};

TEST_F(PoseFactorTest, IsTheOffsetWhereItWasLinearised) {
  const SplinePose pose = PoseAt(0.4);
  measurement_.world_from_body = pose.world_from_body;
  measurement_.position = pose.position;
  const auto factor = CreatePoseFactor(measurement_, 0.4);
  EXPECT_LT((blocks_.Residuals(*factor) - measurement_.offset).norm(), 1e-12);
}

TEST_F(PoseFactorTest, IsLinearInTheError) {
  const SplinePose pose = PoseAt(0.4);
  const Eigen::Vector3d turn(0.02, -0.03, 0.01);
  const Eigen::Vector3d shift(0.1, 0.2, -0.3);
  // The pose is turned and shifted by this from where it was linearised.
  const Eigen::Quaterniond by(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  measurement_.world_from_body = by.conjugate() * pose.world_from_body;
  measurement_.position = pose.position - shift;
  const auto factor = CreatePoseFactor(measurement_, 0.4);
  Eigen::Matrix<double, 6, 1> error;
  error << turn, shift;
  const Eigen::VectorXd expected = measurement_.offset + measurement_.root * error;
  EXPECT_LT((blocks_.Residuals(*factor) - expected).norm(), 1e-10);
}

TEST_F(PoseFactorTest, Gradients) {
  measurement_.world_from_body = random_.Rotation(0.2) * PoseAt(0.7).world_from_body;
  measurement_.position = random_.Vector(3.0);
  blocks_.ExpectGradientsCorrect(*CreatePoseFactor(measurement_, 0.7));
}

}  // namespace
}  // namespace plumbline
