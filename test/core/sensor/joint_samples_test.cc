#include "core/sensor/joint_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geometry/angles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// A nod of 30 degrees at 1 Hz.
double AngleAt(double time_s) {
  return 30.0 * kRadiansPerDegree * std::sin(2.0 * M_PI * time_s);
}

// 20 s of it, read at 100 Hz with this noise.
std::vector<JointSample> Nod(double noise_deg) {
  std::mt19937 engine(4);
  std::normal_distribution<double> noise(0.0, noise_deg * kRadiansPerDegree);
  std::vector<JointSample> samples;
  for (int i = 0; i < 2000; ++i) {
    const double time_s = 0.01 * i;
    samples.push_back({NanosecondsFromSeconds(time_s), AngleAt(time_s) + noise(engine)});
  }
  return samples;
}

double RmsErrorDeg(const std::vector<JointSample>& samples) {
  double sum = 0.0;
  for (const JointSample& sample : samples) {
    sum += std::pow(sample.angle_rad - AngleAt(SecondsBetween(0, sample.time_ns)), 2);
  }
  return kDegreesPerRadian * std::sqrt(sum / static_cast<double>(samples.size()));
}

TEST(JointSamples, SmoothingTakesMostOfTheNoise) {
  std::vector<JointSample> samples = Nod(0.01);
  Smooth(&samples);
  EXPECT_LT(RmsErrorDeg(samples), 0.0045);
}

TEST(JointSamples, AnglesWithoutNoiseStay) {
  std::vector<JointSample> samples = Nod(1e-9);
  Smooth(&samples);
  EXPECT_LT(RmsErrorDeg(samples), 1e-6);
}

// Nothing is taken for smooth across a gap of half a turn of the swing.
TEST(JointSamples, SmoothingStopsAtGaps) {
  std::vector<JointSample> samples = Nod(0.01);
  samples.erase(samples.begin() + 1000, samples.begin() + 1050);
  Smooth(&samples);
  EXPECT_LT(RmsErrorDeg(samples), 0.008);
}

TEST(JointSamples, SortsAndUnwraps) {
  std::vector<JointSample> samples = {
      {20, -3.1}, {0, 3.0}, {0, 1.0}, {10, std::nan("")}, {30, -3.0}};
  SortAndUnwrap(&samples);
  ASSERT_EQ(samples.size(), 3u);
  EXPECT_EQ(samples[0].angle_rad, 3.0);
  EXPECT_NEAR(samples[1].angle_rad, 2.0 * M_PI - 3.1, 1e-12);
  EXPECT_NEAR(samples[2].angle_rad, 2.0 * M_PI - 3.0, 1e-12);
}

}  // namespace
}  // namespace plumbline
