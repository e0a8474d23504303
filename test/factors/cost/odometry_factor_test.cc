#include "factors/cost/odometry_factor.h"

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "factors/spline/so3.h"
#include "factors/spline/spline.h"
#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

constexpr int kNumControlPoints = 6;
constexpr SplineNode kBegin = {0, 0.3};
constexpr SplineNode kEnd = {2, 0.6};

// A motion that begins with some rotation and turns by `step` from control point to control
// point.
class OdometryFactorTest : public testing::Test {
 protected:
  void MakeMotion(double step) { blocks_.AddSpline(kNumControlPoints, step, &random_); }

  SplinePose PoseAt(const SplineNode& at) {
    const std::vector<const double*> data = blocks_.pointers();
    const double* const* rotations = data.data() + at.first;
    return EvaluatePose(rotations, rotations + kNumControlPoints, at.u, nullptr);
  }

  // What wheels without an error say of the motion.
  OdometryMeasurement Perfect() {
    const SplinePose begin = PoseAt(kBegin);
    const SplinePose end = PoseAt(kEnd);
    OdometryMeasurement measurement;
    measurement.translation =
        (begin.world_from_body.conjugate() * (end.position - begin.position)).head<2>();
    const Eigen::Quaterniond turn = begin.world_from_body.conjugate() * end.world_from_body;
    measurement.turn = Log(turn).z();
    measurement.translation_stddev = 0.01;
    measurement.turn_stddev = 0.005;
    return measurement;
  }

  static std::unique_ptr<ceres::CostFunction> Factor(const OdometryMeasurement& measurement) {
    return CreateOdometryFactor(measurement, kBegin, kEnd, kNumControlPoints);
  }

  TestRandom random_{3};
  TestBlocks blocks_;
};

TEST_F(OdometryFactorTest, ByHand) {
  // The rig looks along the world's y axis and moves along it by 0.2 m a knot interval,
  // without turning: 0.46 m in 2.3 intervals.
  const Eigen::Quaterniond along_y(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));
  for (int i = 0; i < kNumControlPoints; ++i) blocks_.AddRotation(along_y);
  for (int i = 0; i < kNumControlPoints; ++i)
    blocks_.AddEuclidean(Eigen::Vector3d(1, 0.2 * i, 5));
  OdometryMeasurement measurement;
  measurement.translation = {0.45, 0.03};
  measurement.turn = -0.2;
  measurement.translation_stddev = 0.01;
  measurement.turn_stddev = 0.1;
  const Eigen::VectorXd residuals = blocks_.Residuals(*Factor(measurement));
  ASSERT_EQ(residuals.size(), 3);
  EXPECT_NEAR(residuals[0], 1.0, 1e-9);   // 0.46 m ahead instead of 0.45 m
  EXPECT_NEAR(residuals[1], -3.0, 1e-9);  // not 0.03 m to the left
  EXPECT_NEAR(residuals[2], 2.0, 1e-9);   // no turn instead of -0.2 rad
}

TEST_F(OdometryFactorTest, IsZeroOnPerfectData) {
  MakeMotion(0.3);
  EXPECT_LT(blocks_.Residuals(*Factor(Perfect())).norm(), 1e-9);
}

TEST_F(OdometryFactorTest, SaysNothingOfWhereTheRigIs) {
  MakeMotion(0.3);
  OdometryMeasurement measurement = Perfect();
  measurement.turn += 0.01;
  const auto factor = Factor(measurement);
  const Eigen::VectorXd before = blocks_.Residuals(*factor);
  const Eigen::Quaterniond turn = random_.Rotation(2.0);
  const Eigen::Vector3d shift = random_.Vector(50.0);
  for (int i = 0; i < kNumControlPoints; ++i) {
    Eigen::Map<Eigen::Quaterniond> rotation(blocks_[i].data());
    rotation = turn * rotation;
    Eigen::VectorXd& position = blocks_[kNumControlPoints + i];
    position = turn * Eigen::Vector3d(position) + shift;
  }
  EXPECT_LT((blocks_.Residuals(*factor) - before).norm(), 1e-8);
}

TEST_F(OdometryFactorTest, GradientsWithoutTurn) {
  MakeMotion(0.0);
  blocks_.ExpectGradientsCorrect(*Factor(Perfect()));
}

TEST_F(OdometryFactorTest, GradientsOfLargeTurns) {
  MakeMotion(0.8);
  OdometryMeasurement measurement = Perfect();
  measurement.turn += 0.4;
  measurement.translation.x() += 0.3;
  blocks_.ExpectGradientsCorrect(*Factor(measurement));
}

}  // namespace
}  // namespace plumbline
