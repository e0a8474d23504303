#include "factors/cost/point_factor.h"

#include <gtest/gtest.h>

#include "factors/spline/so3.h"
#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

constexpr double kHalfPi = 1.57079632679489661923;

Eigen::VectorXd PlaneParameters(PlaneModel model, TestRandom* random) {
  Eigen::VectorXd params(PlaneModelSize(model));
  for (double& value : params) value = random->Uniform(-2.0, 2.0);
  return params;
}

TEST(PointFactor, ByHand) {
  // A body at (1, 2, 3) that looks along world y; the scanner sits 0.5 m in front of its
  // origin and is turned to the body's left. A point 2 m ahead of the scanner lies at body
  // (0.5, 2, 0), which is world (1, 2, 3) + (-2, 0.5, 0).
  TestBlocks blocks;
  const Eigen::Quaterniond left = Exp(Eigen::Vector3d(0.0, 0.0, kHalfPi));
  for (int j = 0; j < 4; ++j) blocks.AddRotation(left);
  for (int j = 0; j < 4; ++j) blocks.AddEuclidean(Eigen::Vector3d(1.0, 2.0, 3.0));
  blocks.AddRotation(left);
  blocks.AddEuclidean(Eigen::Vector3d(0.5, 0.0, 0.0));
  blocks.AddEuclidean(Eigen::Vector2d(0.0, -1.25));
  const PointMeasurement measurement{Eigen::Vector2d(2.0, 0.0), 0.4, 10.0};
  const auto factor = CreatePointFactor(measurement, PlaneModel::kVertical, {});
  EXPECT_NEAR(blocks.Residuals(*factor)[0], 10.0 * (-1.0 + 1.25), 1e-12);

  blocks[10][1] = -1.0;  // on the plane
  EXPECT_NEAR(blocks.Residuals(*factor)[0], 0.0, 1e-12);
  blocks.ExpectGradientsCorrect(*factor);
}

TEST(PointFactor, CeilingsNormalPointsDown) {
  TestBlocks blocks;
  for (int j = 0; j < 4; ++j) blocks.AddRotation(Eigen::Quaterniond::Identity());
  for (int j = 0; j < 4; ++j) blocks.AddEuclidean(Eigen::Vector3d(0.0, 0.0, 2.5));
  blocks.AddRotation(Eigen::Quaterniond::Identity());
  blocks.AddEuclidean(Eigen::Vector3d::Zero());
  blocks.AddEuclidean(Eigen::VectorXd::Constant(1, -3.0));
  const PointMeasurement measurement{Eigen::Vector2d(1.0, 1.0), 0.0, 1.0};
  EXPECT_NEAR(
      blocks.Residuals(*CreatePointFactor(measurement, PlaneModel::kHorizontal, {-1.0}))[0],
      0.5,
      1e-12);
}

TEST(PointFactor, GradientsForAllPlaneModelsAndFarRotations) {
  TestRandom random(13);
  for (const PlaneModel model :
       {PlaneModel::kHorizontal, PlaneModel::kVertical, PlaneModel::kGeneral}) {
    for (const double step : {0.0, 0.1, 2.5}) {
      TestBlocks blocks;
      blocks.AddSpline(4, step, &random);
      blocks.AddRotation(random.Rotation(2.0));
      blocks.AddEuclidean(random.Vector(1.0));
      blocks.AddEuclidean(PlaneParameters(model, &random));
      const PointMeasurement measurement{Eigen::Vector2d(3.0, -1.0), 0.7, 30.0};
      blocks.ExpectGradientsCorrect(*CreatePointFactor(measurement, model, random.Chart()));
    }
  }
}

}  // namespace
}  // namespace plumbline
