#include "factors/imu/imu_motion.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

// The factors' tests check the derivatives. A reading of an IMU that looks to the left: its x
// axis is the body's y axis.
TEST(ImuMotion, AReadingByHand) {
  const Eigen::Quaterniond level = Eigen::Quaterniond::Identity();
  std::array<double, kImuBlockSize> imu = {};
  imu[kImuGyroscopeScaleAt] = 0.1;
  const std::array<double, kImuBiasSize> bias = {1.0, 0.0, 0.0};
  const std::array<double, kImuBiasSize> next_bias = {2.0, 0.0, 0.0};
  const double* q = level.coeffs().data();
  const ReadingBlocks<const double*> blocks = {
      {q, q, q, q}, imu.data(), bias.data(), next_bias.data()};
  ImuPose stated;
  stated.body_from_imu = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ());
  ImuMeasurement measurement;
  measurement.mean = Eigen::Vector3d(5.0, 0.0, 0.0);
  measurement.stddev = Eigen::Vector3d(0.5, 1.0, 1.0);
  measurement.bias_share = 0.25;
  BodyReading reading;
  reading.value = Eigen::Vector3d(0.0, 3.0, 0.0);
  Eigen::Vector3d residuals;
  const Eigen::Matrix3d by_value = EvaluateReading(measurement,
                                                   stated,
                                                   0.05,
                                                   kImuGyroscopeScaleAt,
                                                   reading,
                                                   StepsBetween(blocks.rotations),
                                                   blocks,
                                                   residuals.data(),
                                                   {});
  // 1.1 * 3 and a bias of 1.25, where 5 is read.
  EXPECT_NEAR(residuals[0], (1.1 * 3.0 + 1.25 - 5.0) / 0.5, 1e-12);
  EXPECT_NEAR(residuals[1], 0.0, 1e-12);
  EXPECT_NEAR(by_value(0, 1), 1.1 / 0.5, 1e-12);
}

}  // namespace
}  // namespace plumbline
