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
  imu.ExtendTo(201);
  // Interval 200 lies between nodes 2 and 3.
  ASSERT_EQ(imu.num_biases(), 4);
  EXPECT_EQ(imu.biases[3].gyroscope[1], 0.5);
  for (int node = 0; node < 5; ++node) {
    EXPECT_EQ(imu.NodeOfLastInterval(imu.LastIntervalOf(node)), node);
  }
  EXPECT_EQ(imu.LastIntervalOf(1), 199);
}

// A bias that wanders by a reading's white noise in 2 s has nodes 2 s apart.
TEST(ImuEstimateTest, NodesLieAsCloseAsBiasesWander) {
  Imu imu;
  imu.gyroscope.noise = 1e-4;
  imu.gyroscope.bias_instability = imu.gyroscope.noise / std::sqrt(std::sqrt(0.75) * 2.0);
  EXPECT_EQ(ImuEstimate(imu, false, 0.05).intervals_per_bias, 40);
  // The accelerometer of a rig in the plane is not used.
  imu.accelerometer = imu.gyroscope;
  imu.gyroscope.bias_instability = 0.0;
  EXPECT_EQ(ImuEstimate(imu, false, 0.05).intervals_per_bias, 40);
  EXPECT_EQ(ImuEstimate(imu, true, 0.05).intervals_per_bias, 100);
}

TEST(ImuEstimateTest, ARigInThePlaneHasAGyroscopeAlone) {
  Imu imu;
  imu.rotation_rad = 0.01;
  imu.time_s = 0.002;
  imu.gyroscope.scale = imu.accelerometer.scale = 0.03;
  const ImuEstimate estimate(imu, true, 0.125);
  EXPECT_EQ(estimate.intervals_per_bias, 40);
  EXPECT_EQ(estimate.prior_sigma[kImuTurnAt], 0.0);
  EXPECT_EQ(estimate.prior_sigma[kImuDelayAt], 0.002);
  EXPECT_EQ(estimate.prior_sigma[kImuGyroscopeScaleAt], 0.03);
  EXPECT_EQ(estimate.prior_sigma[kImuAccelerometerScaleAt], 0.0);
  EXPECT_EQ(estimate.prior_sigma[kImuLeanAt], 0.0);
}

}  // namespace
}  // namespace plumbline
