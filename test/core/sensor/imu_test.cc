#include "core/sensor/imu.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace plumbline {
namespace {

constexpr int64_t kStep = 10'000'000;  // ns

// Readings whose rate about x is their number, of an IMU at rest.
std::vector<ImuSample> Samples(int count) {
  std::vector<ImuSample> samples;
  for (int i = 0; i < count; ++i) {
    samples.push_back({i * kStep,
                       Eigen::Vector3d(i, 0.0, 0.0),
                       Eigen::Vector3d(0.0, 0.0, kStandardGravity)});
  }
  return samples;
}

TEST(ImuTest, BiasWalkHasTheLeastAllanDeviation) {
  InertialErrors errors;
  errors.noise = 0.02;
  errors.bias_instability = 0.004;
  double least = 1.0;
  for (double time_s = 0.1; time_s < 1e4; time_s *= 1.01) {
    const double walk = errors.BiasWalk();
    least = std::min(
        least, std::sqrt(errors.noise * errors.noise / time_s + walk * walk * time_s / 3.0));
  }
  EXPECT_NEAR(least, errors.bias_instability, 1e-6);
  EXPECT_EQ(InertialErrors().BiasWalk(), 0.0);
}

TEST(ImuTest, MeansAreThoseOfTheReadingsOfTheTime) {
  const ImuReadings readings(Samples(10), Imu());
  EXPECT_DOUBLE_EQ(readings.period_s(), 0.01);
  const ImuMean mean = readings.MeanOf(2 * kStep, 5 * kStep);
  EXPECT_EQ(mean.num_samples, 3);
  EXPECT_DOUBLE_EQ(mean.angular_rate.x(), 3.0);
  EXPECT_DOUBLE_EQ(mean.specific_force.z(), kStandardGravity);
  EXPECT_DOUBLE_EQ(mean.time_s, 0.01);
  EXPECT_NEAR(mean.time_stddev_s, 0.01 * std::sqrt(2.0 / 3.0), 1e-12);
  EXPECT_EQ(readings.MeanOf(20 * kStep, 30 * kStep).num_samples, 0);
}

TEST(ImuTest, SamplesComeInAnyOrderOnceEachAndFinite) {
  std::vector<ImuSample> samples = Samples(4);
  samples.push_back({kStep, Eigen::Vector3d(100.0, 0.0, 0.0), Eigen::Vector3d::Zero()});
  samples.push_back({5 * kStep,
                     Eigen::Vector3d(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0),
                     Eigen::Vector3d::Zero()});
  std::swap(samples[0], samples[3]);
  const ImuReadings readings(samples, Imu());
  EXPECT_EQ(readings.size(), 4u);
  EXPECT_DOUBLE_EQ(readings.MeanOf(kStep, 2 * kStep).angular_rate.x(), 1.0);
}

TEST(ImuTest, ThereIsNoMeanWhereAReadingIsAtTheEndOfItsRange) {
  Imu imu;
  imu.gyroscope.range = 5.0;
  const ImuReadings readings(Samples(10), imu);
  EXPECT_EQ(readings.MeanOf(2 * kStep, 5 * kStep).num_samples, 3);
  EXPECT_EQ(readings.MeanOf(2 * kStep, 6 * kStep).num_samples, 0);
}

TEST(ImuTest, GravityTellsTheUnit) {
  EXPECT_EQ(ImuReadings(Samples(10), Imu()).Fault(), "");
  EXPECT_EQ(ImuReadings({}, Imu()).Fault(), "it has no readings");
  std::vector<ImuSample> in_g = Samples(10);
  for (ImuSample& sample : in_g) sample.specific_force /= kStandardGravity;
  EXPECT_EQ(ImuReadings(in_g, Imu()).Fault(),
            "its accelerations are 1.00 m/s^2 as a rule, where gravity alone is 9.81 (other "
            "units, or gravity taken off?)");
}

}  // namespace
}  // namespace plumbline
