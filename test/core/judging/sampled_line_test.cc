#include "core/judging/sampled_line.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'600'000'000'000'000'000;

// A line of one segment across the x axis.
SampledLine WallAt(double x, int64_t stamp_ns = kStart) {
  SampledLine line;
  line.stamp_ns = stamp_ns;
  line.segments.push_back({{x, -1.0}, {x, 1.0}});
  return line;
}

TEST(SampledLineTest, InstantIsThatOfTheBeamTowardsThePoint) {
  SampledLine line;
  line.stamp_ns = kStart;
  line.angle_min = -0.5 * M_PI;
  line.angle_increment = 0.01;
  line.time_increment_s = 1e-4;
  EXPECT_EQ(line.InstantAt({0.0, -2.0}), kStart);
  EXPECT_NEAR(static_cast<double>(line.InstantAt({3.0, 0.0}) - kStart),
              0.5 * M_PI / 0.01 * 1e-4 * 1e9,
              1.0);
  // Clockwise it takes the other way round.
  line.angle_increment = -0.01;
  EXPECT_NEAR(static_cast<double>(line.InstantAt({3.0, 0.0}) - kStart),
              1.5 * M_PI / 0.01 * 1e-4 * 1e9,
              1.0);
}

TEST(RangeAlongTest, NearestSegmentCounts) {
  SampledLine line = WallAt(3.0);
  line.segments.push_back({{2.0, 0.5}, {2.0, -0.5}});
  const Eigen::Vector2d ahead = Eigen::Vector2d::UnitX();
  EXPECT_NEAR(RangeAlong(line, ahead), 2.0, 1e-12);
  const Eigen::Vector2d aside = Eigen::Vector2d(3.0, 0.9).normalized();
  EXPECT_NEAR(RangeAlong(line, aside), std::hypot(3.0, 0.9), 1e-12);
  EXPECT_LT(RangeAlong(line, -ahead), 0.0);  // behind the scanner
  EXPECT_LT(RangeAlong(line, Eigen::Vector2d::UnitY()), 0.0);
  EXPECT_LT(RangeAlong(SampledLine(), ahead), 0.0);
}

TEST(SeesTheSameTest, MostSegmentsHaveToBeWhereTheOtherLineSawSomething) {
  EXPECT_TRUE(SeesTheSame(WallAt(3.0), WallAt(3.05), 0.1));
  EXPECT_FALSE(SeesTheSame(WallAt(3.0), WallAt(3.2), 0.1));
  EXPECT_FALSE(SeesTheSame(WallAt(3.0), SampledLine(), 0.1));
  SampledLine three = WallAt(3.0);
  three.segments.push_back({{-1.0, 2.0}, {1.0, 2.0}});
  three.segments.push_back({{-1.0, -2.0}, {1.0, -2.0}});
  SampledLine two = three;
  two.segments.pop_back();
  EXPECT_TRUE(SeesTheSame(three, two, 0.1));
  two.segments.pop_back();
  EXPECT_FALSE(SeesTheSame(three, two, 0.1));
}

TEST(RangeRateTest, IsTheSpeedTowardsTheWall) {
  std::vector<SampledLine> lines;
  for (int i = 0; i < 9; ++i) lines.push_back(WallAt(3.0 - 0.02 * i, kStart + i * 50'000'000));
  EXPECT_NEAR(RangeRate(lines, 4, {3.0 - 0.08, 0.0}), -0.4, 1e-9);
  // Obliquely, the range changes faster.
  const Eigen::Vector2d oblique(3.0 - 0.08, 0.9);
  EXPECT_NEAR(RangeRate(lines, 4, oblique), -0.4 / oblique.normalized().x(), 1e-9);
}

TEST(RangeRateTest, NeedsLinesBeforeAndAfter) {
  std::vector<SampledLine> lines;
  for (int i = 0; i < 5; ++i) lines.push_back(WallAt(3.0, kStart + i * 50'000'000));
  EXPECT_TRUE(std::isnan(RangeRate(lines, 0, {3.0, 0.0})));
  EXPECT_TRUE(std::isnan(RangeRate(lines, 4, {3.0, 0.0})));
  EXPECT_NEAR(RangeRate(lines, 1, {3.0, 0.0}), 0.0, 1e-9);
  // Lines that are seconds apart, and those that see another surface, do not tell.
  lines[0].stamp_ns -= 2'000'000'000;
  EXPECT_TRUE(std::isnan(RangeRate(lines, 1, {3.0, 0.0})));
  lines[1] = WallAt(7.0, lines[1].stamp_ns);
  EXPECT_TRUE(std::isnan(RangeRate(lines, 2, {3.0, 0.0})));
}

// A scanner 2 m before a wall that is 4 m wide, and a post of 10 cm.
TEST(SegmentSampleTest, WallsAreSegmentsAndPostsAreNot) {
  ScanLine line;
  line.stamp_ns = kStart;
  line.angle_min = -1.4;
  line.angle_increment = 0.01;
  line.time_increment_s = 1e-5;
  for (int i = 0; i < 280; ++i) {
    const double angle = line.BeamAngle(i);
    double range = std::nan("");
    if (std::abs(angle) < M_PI / 4.0) range = 2.0 / std::cos(angle);
    if (angle > 1.2 && angle < 1.3) range = 1.0 / std::cos(angle - 1.25);
    line.ranges.push_back(static_cast<float>(range));
  }
  const std::vector<SampledLine> sample = SegmentSample({line, ScanLine()}, 0.01);
  ASSERT_EQ(sample.size(), 2u);
  EXPECT_EQ(sample[0].stamp_ns, kStart);
  EXPECT_EQ(sample[0].angle_increment, 0.01);
  ASSERT_EQ(sample[0].segments.size(), 1u);
  EXPECT_NEAR(sample[0].segments[0].start.x(), 2.0, 1e-3);
  EXPECT_NEAR(sample[0].segments[0].length_m(), 4.0, 0.06);
  EXPECT_TRUE(sample[1].segments.empty());
}

}  // namespace
}  // namespace plumbline
