#include "simulation/sensing/wheels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/util/time.h"
#include "test/testing/test_files.h"

namespace plumbline {
namespace {

constexpr double kLength = 10.0;  // m
constexpr double kSpeed = 0.5;    // m/s
constexpr int kDraws = 400;
// Sampled standard deviations are good to 1 / sqrt(2 * 400) = 3.5 %, four sigmas.
constexpr double kTolerance = 0.14;

// 10 m along a line, or round a corner to the left.
Path Way(bool has_corner) {
  PathOptions options;
  options.way_points = {{{1.0, 2.0}, ""}, {{1.0, 8.0}, ""}};
  options.way_points.push_back(
      {has_corner ? Eigen::Vector2d(-20.0, 8.0) : Eigen::Vector2d(1.0, 30.0), ""});
  options.length_m = kLength;
  options.speed_m_s = kSpeed;
  options.start_ns = 1'400'000'000'000'000'000;
  return Path(options);
}

// The standard deviation, and the mean, of what wheels count in the end.
std::pair<double, double> Spread(
    const WheelOptions& options,
    const std::function<double(const OdometrySample&)>& value_of) {
  const Path path = Way(false);
  double sum = 0.0;
  double squares = 0.0;
  for (int seed = 1; seed <= kDraws; ++seed) {
    const double value = value_of(WheelSamples(path, options, seed).back());
    sum += value;
    squares += value * value;
  }
  const double mean = sum / kDraws;
  return {std::sqrt(squares / kDraws - mean * mean), mean};
}

TEST(WheelsTest, RightWheelsCountTheWayInAFrameOfTheirOwn) {
  const Path path = Way(true);
  const std::vector<OdometrySample> samples = WheelSamples(path, WheelOptions(), 1);
  EXPECT_EQ(samples.front().time_ns, path.start_ns());
  EXPECT_EQ(samples.size(), 1u + static_cast<size_t>(kLength / kSpeed * 50.0));
  const Rigid3d start = path.PoseAt(path.start_ns());
  for (const size_t i : {0ul, 300ul, 650ul, 1000ul}) {
    const Rigid3d pose = path.PoseAt(samples[i].time_ns);
    const Eigen::Vector3d expected =
        start.rotation.conjugate() * (pose.translation - start.translation);
    EXPECT_LT((samples[i].position - expected.head<2>()).norm(), 1e-9) << i;
  }
  EXPECT_NEAR(samples.front().heading, 0.0, 1e-12);
  EXPECT_NEAR(samples.back().heading, M_PI / 2.0, 1e-9);
}

TEST(WheelsTest, ScalesAndClock) {
  WheelOptions options;
  options.length_scale = 1.1;
  options.turn_scale = 0.8;
  options.clock_late_s = 0.25;
  options.rate_hz = 20.0;
  const Path path = Way(true);
  const std::vector<OdometrySample> samples = WheelSamples(path, options, 1);
  EXPECT_NEAR(SecondsBetween(path.start_ns(), samples.front().time_ns), 0.25, 1e-9);
  EXPECT_NEAR(SecondsBetween(samples[0].time_ns, samples[1].time_ns), 0.05, 1e-9);
  double counted = 0.0;
  for (size_t i = 1; i < samples.size(); ++i) {
    counted += (samples[i].position - samples[i - 1].position).norm();
  }
  EXPECT_NEAR(counted, 1.1 * (path.TravelledAt(path.end_ns())), 2e-3);  // chords of the corner
  EXPECT_NEAR(samples.back().heading, 0.8 * M_PI / 2.0, 1e-9);
}

TEST(WheelsTest, NoiseGrowsWithTheRootOfTheWay) {
  WheelOptions options;
  options.length_noise_m = 0.02;
  const auto [along, mean] =
      Spread(options, [](const OdometrySample& end) { return end.position.x(); });
  EXPECT_NEAR(along / (0.02 * std::sqrt(kLength)), 1.0, kTolerance);
  EXPECT_NEAR(mean, kLength, 4.0 * 0.02 * std::sqrt(kLength / kDraws));
  options = WheelOptions();
  options.turn_noise_rad = 0.01;
  const auto [turn, turned] =
      Spread(options, [](const OdometrySample& end) { return end.heading; });
  EXPECT_NEAR(turn / (0.01 * std::sqrt(kLength)), 1.0, kTolerance);
  EXPECT_NEAR(turned, 0.0, 4.0 * 0.01 * std::sqrt(kLength / kDraws));
}

TEST(WheelsTest, SlippingWheelsCountTooMuch) {
  WheelOptions options;
  options.slips_per_m = 0.2;
  options.slip_share = 0.5;
  options.slip_s = 0.2;
  const auto [spread, mean] =
      Spread(options, [](const OdometrySample& end) { return end.position.x(); });
  // Two slips of 0.1 m of which half is counted on top; Poisson.
  const double slip_m = 0.5 * 0.2 * kSpeed;
  EXPECT_NEAR(mean - kLength, 2.0 * slip_m, 4.0 * slip_m * std::sqrt(2.0 / kDraws));
  EXPECT_GT(spread, 0.5 * slip_m);
}

TEST(WheelsTest, ErrorsNameFileAndLine) {
  const auto error = [](const std::string& text) {
    return ErrorOf([&] { ReadWheels(YamlNode::ReadText(text, "wheels.yaml")); });
  };
  EXPECT_EQ(error("rate_hz: 20\ncolour: red\n"), "wheels.yaml:2: unknown key 'colour'");
  EXPECT_EQ(error("topic: ''\n"), "wheels.yaml:1: 'topic' must be a text");
  EXPECT_EQ(error("slips:\n  share: 0.5\n").rfind("wheels.yaml:2", 0), 0u);
}

TEST(WheelsTest, StalePosesAreSentAgain) {
  const Path path = Way(false);
  WheelOptions options;
  options.stale_per_s = 0.5;
  options.stale_s = 0.3;
  const std::vector<OdometrySample> right = WheelSamples(path, WheelOptions(), 1);
  const std::vector<OdometrySample> stale = WheelSamples(path, options, 1);
  ASSERT_EQ(stale.size(), right.size());
  int num_stale = 0;
  for (size_t i = 1; i < stale.size(); ++i) {
    EXPECT_EQ(stale[i].time_ns, right[i].time_ns);
    if (stale[i].position != right[i].position) {
      EXPECT_EQ(stale[i].position, stale[i - 1].position);
      ++num_stale;
    }
  }
  // Half a time a second, for 15 samples: of 1000 about 130.
  EXPECT_GT(num_stale, 50);
  EXPECT_LT(num_stale, 300);
}

}  // namespace
}  // namespace plumbline
