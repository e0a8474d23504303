#include "core/map/imu_estimate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

// Nodes are known by the last knot interval that they have a say in.
TEST(ImuEstimateTest, NodesAndIntervals) {
  ImuEstimate imu(Imu(), false, 0.05);
  EXPECT_EQ(imu.num_biases(), 1);
  imu.biases[0].gyroscope[1] = 0.5;
  imu.ExtendTo(17);
  // Interval 16 lies between nodes 2 and 3.
  ASSERT_EQ(imu.num_biases(), 4);
  EXPECT_EQ(imu.biases[3].gyroscope[1], 0.5);
  for (int node = 0; node < 5; ++node) {
    EXPECT_EQ(imu.NodeOfLastInterval(imu.LastIntervalOf(node)), node);
  }
  EXPECT_EQ(imu.LastIntervalOf(1), 15);
}

// A bias that wanders by a reading's white noise in 0.2 s has nodes 0.2 s apart, but not less
// than 8 knot intervals.
TEST(ImuEstimateTest, NodesLieAsCloseAsBiasesWander) {
  Imu imu;
  imu.gyroscope.noise = 1e-4;
  imu.gyroscope.bias_instability = imu.gyroscope.noise / std::sqrt(std::sqrt(0.75) * 0.2);
  EXPECT_EQ(ImuEstimate(imu, false, 0.02).intervals_per_bias, 10);
  EXPECT_EQ(ImuEstimate(imu, false, 0.05).intervals_per_bias, 8);
  // The accelerometer of a rig in the plane is not used.
  imu.accelerometer = imu.gyroscope;
  imu.gyroscope.bias_instability = 0.0;
  EXPECT_EQ(ImuEstimate(imu, false, 0.02).intervals_per_bias, 10);
  EXPECT_EQ(ImuEstimate(imu, true, 0.02).intervals_per_bias, 20);
}

TEST(ImuEstimateTest, ARigInThePlaneHasAGyroscopeAlone) {
  Imu imu;
  imu.rotation_rad = 0.01;
  imu.time_s = 0.002;
  imu.gyroscope.scale = imu.accelerometer.scale = 0.03;
  const ImuEstimate estimate(imu, true, 0.125);
  EXPECT_EQ(estimate.intervals_per_bias, 8);
  EXPECT_EQ(estimate.prior_sigma[kImuTurnAt], 0.0);
  EXPECT_EQ(estimate.prior_sigma[kImuDelayAt], 0.002);
  EXPECT_EQ(estimate.prior_sigma[kImuGyroscopeScaleAt], 0.03);
  EXPECT_EQ(estimate.prior_sigma[kImuAccelerometerScaleAt], 0.0);
  EXPECT_EQ(estimate.prior_sigma[kImuLeanAt], 0.0);
}

}  // namespace
}  // namespace plumbline
