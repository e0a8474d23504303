#include "factors/imu/gyroscope_factor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "test/factors/imu/imu_factor_testing.h"

namespace plumbline {
namespace {

class GyroscopeFactorTest : public ImuFactorTest {
 protected:
  // The spline's rotations alone.
  void MakeTurn(double step) {
    MakeMotion(step);
    TestBlocks rotations;
    for (int i = 0; i < kSplineOrder; ++i) {
      rotations.AddRotation(Eigen::Quaterniond(blocks_[i].data()));
    }
    all_ = std::move(blocks_);
    blocks_ = std::move(rotations);
    AddImuBlocks();
  }

  ImuMeasurement Perfect(double share) {
    std::swap(all_, blocks_);
    ImuMeasurement measurement;
    measurement.u = {0.2, 0.6};
    measurement.bias_share = share;
    measurement.mean = Reading(0.5 * (RateAt(0.2) + RateAt(0.6)), kImuGyroscopeScaleAt, share);
    measurement.stddev = Eigen::Vector3d(0.01, 0.02, 0.03);
    std::swap(all_, blocks_);
    return measurement;
  }

  std::unique_ptr<ceres::CostFunction> Factor(const ImuMeasurement& measurement) const {
    return CreateGyroscopeFactor(measurement, stated_, kTestInterval);
  }

  TestBlocks all_;
};

TEST_F(GyroscopeFactorTest, ByHand) {
  // The body turns by 0.1 rad about its z axis from control point to control point, 2 rad/s.
  // The IMU's x axis points up; it reads 1 % too much, and its bias is 0.5 rad/s halfway
  // between 0 and 1.
  for (int i = 0; i < kSplineOrder; ++i) {
    blocks_.AddRotation(
        Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * i, Eigen::Vector3d::UnitZ())));
  }
  Eigen::VectorXd imu = Eigen::VectorXd::Zero(kImuBlockSize);
  imu[kImuGyroscopeScaleAt] = 0.01;
  blocks_.AddEuclidean(imu);
  blocks_.AddEuclidean(Eigen::Vector3d::Zero());
  blocks_.AddEuclidean(Eigen::Vector3d::Ones());
  stated_.body_from_imu = Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitY());
  ImuMeasurement measurement;
  measurement.mean = Eigen::Vector3d(2.5, 0.4, 0.5);
  measurement.stddev = Eigen::Vector3d(0.1, 0.05, std::numeric_limits<double>::infinity());
  measurement.u = {0.1, 0.9};
  measurement.bias_share = 0.5;
  const Eigen::VectorXd residuals = blocks_.Residuals(*Factor(measurement));
  ASSERT_EQ(residuals.size(), 3);
  EXPECT_NEAR(residuals[0], 0.2, 1e-9);  // 2 * 1.01 + 0.5 instead of 2.5
  EXPECT_NEAR(residuals[1], 2.0, 1e-9);  // 0.5 instead of 0.4
  EXPECT_EQ(residuals[2], 0.0);          // no measurement
}

TEST_F(GyroscopeFactorTest, IsZeroOnPerfectData) {
  MakeTurn(0.2);
  EXPECT_LT((0.03 * blocks_.Residuals(*Factor(Perfect(0.3)))).norm(), 1e-5);
}

TEST_F(GyroscopeFactorTest, SaysNothingOfWhereTheRigLooks) {
  MakeTurn(0.2);
  const auto factor = Factor(Perfect(0.3));
  const Eigen::VectorXd before = blocks_.Residuals(*factor);
  const Eigen::Quaterniond turn = random_.Rotation(2.0);
  for (int i = 0; i < kSplineOrder; ++i) {
    Eigen::Map<Eigen::Quaterniond> rotation(blocks_[i].data());
    rotation = turn * rotation;
  }
  EXPECT_LT((blocks_.Residuals(*factor) - before).norm(), 1e-9);
}

TEST_F(GyroscopeFactorTest, GradientsWithoutTurn) {
  MakeTurn(0.0);
  blocks_.ExpectGradientsCorrect(*Factor(Perfect(0.3)), 1e-6);
}

TEST_F(GyroscopeFactorTest, GradientsOfLargeTurns) {
  MakeTurn(0.6);
  ImuMeasurement measurement = Perfect(0.7);
  measurement.mean.x() += 1.0;
  blocks_.ExpectGradientsCorrect(*Factor(measurement), 1e-6);
}

}  // namespace
}  // namespace plumbline
