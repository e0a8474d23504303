#include "factors/imu/accelerometer_factor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test/factors/imu/imu_factor_testing.h"

namespace plumbline {
namespace {

class AccelerometerFactorTest : public ImuFactorTest {
 protected:
  void MakeWalk(double step) {
    MakeMotion(step);
    // Some metres per second squared, not hundreds.
    for (int i = kSplineOrder; i < 2 * kSplineOrder; ++i) blocks_[i] *= 0.01;
    AddImuBlocks();
  }

  ImuMeasurement Perfect(double share) {
    ImuMeasurement measurement;
    measurement.u = {0.2, 0.6};
    measurement.bias_share = share;
    measurement.mean =
        Reading(0.5 * (ForceAt(0.2) + ForceAt(0.6)), kImuAccelerometerScaleAt, share);
    measurement.stddev = Eigen::Vector3d(0.1, 0.2, 0.3);
    return measurement;
  }

  std::unique_ptr<ceres::CostFunction> Factor(const ImuMeasurement& measurement) const {
    return CreateAccelerometerFactor(measurement, stated_, kTestGravity, kTestInterval);
  }
};

TEST_F(AccelerometerFactorTest, ByHand) {
  // The body looks along the world's y axis and accelerates along it by 2 m/s^2. It leans
  // nowhere, gravity does: by a small angle towards x.
  const Eigen::Quaterniond along_y(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));
  for (int i = 0; i < kSplineOrder; ++i) blocks_.AddRotation(along_y);
  for (int i = 0; i < kSplineOrder; ++i) {
    const double time_s = i * kTestInterval;
    blocks_.AddEuclidean(Eigen::Vector3d(1.0, time_s * time_s, 5.0));
  }
  Eigen::VectorXd imu = Eigen::VectorXd::Zero(kImuBlockSize);
  const double lean = 0.01;
  imu[kImuLeanAt + 1] = -lean;
  blocks_.AddEuclidean(imu);
  blocks_.AddEuclidean(Eigen::Vector3d::Zero());
  blocks_.AddEuclidean(Eigen::Vector3d::Zero());
  ImuMeasurement measurement;
  measurement.mean = Eigen::Vector3d(1.9, 0.0, 9.0);
  measurement.stddev = Eigen::Vector3d(0.1, 0.1, 0.1);
  const Eigen::VectorXd residuals = blocks_.Residuals(*Factor(measurement));
  ASSERT_EQ(residuals.size(), 3);
  EXPECT_NEAR(residuals[0], 1.0, 1e-6);  // 2 m/s^2 ahead instead of 1.9
  // Gravity towards x is gravity to the right, so that the reading is one to the left.
  EXPECT_NEAR(residuals[1], kTestGravity * std::sin(lean) / 0.1, 1e-6);
  EXPECT_NEAR(residuals[2], (kTestGravity * std::cos(lean) - 9.0) / 0.1, 1e-6);
}

TEST_F(AccelerometerFactorTest, IsZeroOnPerfectData) {
  MakeWalk(0.2);
  EXPECT_LT((0.3 * blocks_.Residuals(*Factor(Perfect(0.3)))).norm(), 1e-3);
}

TEST_F(AccelerometerFactorTest, SaysNothingOfPlaceSpeedAndHeading) {
  MakeWalk(0.2);
  blocks_[2 * kSplineOrder].segment<2>(kImuLeanAt).setZero();
  const auto factor = Factor(Perfect(0.3));
  const Eigen::VectorXd before = blocks_.Residuals(*factor);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d shift = random_.Vector(5.0);
  const Eigen::Vector3d step = random_.Vector(0.2);
  for (int i = 0; i < kSplineOrder; ++i) {
    Eigen::Map<Eigen::Quaterniond> rotation(blocks_[i].data());
    rotation = turn * rotation;
    Eigen::VectorXd& position = blocks_[kSplineOrder + i];
    position = turn * Eigen::Vector3d(position) + shift + i * step;
  }
  EXPECT_LT((blocks_.Residuals(*factor) - before).norm(), 1e-8);
}

TEST_F(AccelerometerFactorTest, GradientsWithoutTurn) {
  MakeWalk(0.0);
  blocks_.ExpectGradientsCorrect(*Factor(Perfect(0.3)), 1e-6);
}

TEST_F(AccelerometerFactorTest, GradientsOfLargeTurns) {
  MakeWalk(0.5);
  ImuMeasurement measurement = Perfect(0.7);
  measurement.mean.x() += 1.0;
  blocks_.ExpectGradientsCorrect(*Factor(measurement), 1e-6);
}

}  // namespace
}  // namespace plumbline
