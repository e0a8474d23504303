#include "core/segmentation/segmentation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "core/sensor/scanner_motion.h"
#include "test/core/segmentation/segmentation_fixture.h"
#include "test/testing/planar_world.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;

// First and last beam of each run of at least five beams on one wall.
std::vector<std::pair<int, int>> TrueRuns(const PlanarWorldScan& scan) {
  std::vector<std::pair<int, int>> runs;
  const std::vector<int>& walls = scan.wall_of_beam;
  for (int i = 0; i < scan.scan_line.num_beams(); ++i) {
    const size_t k = static_cast<size_t>(i);
    if (walls[k] < 0) continue;
    if (k > 0 && walls[k] == walls[k - 1]) {
      runs.back().second = i;
    } else {
      runs.emplace_back(i, i);
    }
  }
  std::vector<std::pair<int, int>> long_segments;
  for (const auto& run : runs) {
    if (run.second - run.first + 1 >= 5) long_segments.push_back(run);
  }
  return long_segments;
}

// Number of 500 noisy draws in which the segments are not one for each wall seen, or an end
// lies more than `slack` beams beyond the wall's or inside of it by more than `max_left_out`.
int CountWrongDraws(const PlanarWorldScan& scan, double sigma, int slack, int max_left_out) {
  const std::vector<std::pair<int, int>> runs = TrueRuns(scan);
  std::mt19937_64 random(42);
  int num_wrong = 0;
  for (int draw = 0; draw < 500; ++draw) {
    const std::vector<Segment> segments = SegmentScanLine(
        AddRangeNoise(scan.scan_line, sigma, &random), MakeScanner(sigma), {}, {});
    bool is_right = segments.size() == runs.size();
    for (size_t k = 0; is_right && k < runs.size(); ++k) {
      const int before = segments[k].first_beam - runs[k].first;
      const int after = runs[k].second - segments[k].last_beam;
      is_right = before >= -slack && after >= -slack && before <= max_left_out &&
                 after <= max_left_out;
    }
    num_wrong += is_right ? 0 : 1;
  }
  return num_wrong;
}

class NoiseTest : public testing::TestWithParam<Setting> {};

INSTANTIATE_TEST_SUITE_P(Densities,
                         NoiseTest,
                         testing::Values(Setting{90, 0.03},
                                         Setting{270, 0.01},
                                         Setting{270, 0.03},
                                         Setting{1080, 0.01},
                                         Setting{1080, 0.03},
                                         Setting{1440, 0.01}));

// Doubtful beams at a corner of two walls that meet at the angle `bend` at range r: those
// within 3 sigma / bend of it; the factor 3 covers beams that see the corner at a grazing
// angle.
int DoubtfulBeams(const Setting& setting, double bend, double range) {
  const double spacing = range * kFieldOfView / setting.num_beams;
  return 3 + static_cast<int>(3.0 * 3.0 * setting.sigma / (bend * spacing));
}

TEST_P(NoiseTest, RectangularRoom) {
  const PlanarWorldScan scan =
      TakePlanarWorldScan(RectangularRoom(), {0, 0}, 0.2, GetParam().num_beams, kFieldOfView);
  EXPECT_LE(CountWrongDraws(scan, GetParam().sigma, 3, DoubtfulBeams(GetParam(), 1.57, 3.0)),
            kMaxWrongDraws);
}

TEST_P(NoiseTest, Corner) {
  const PlanarWorld world = PlanarWorld().AddWalls({{-1.5, 2}, {3, 2}, {3, -2.5}});
  const PlanarWorldScan scan =
      TakePlanarWorldScan(world, {0, 0}, 0.5, GetParam().num_beams, kFieldOfView);
  EXPECT_LE(CountWrongDraws(scan, GetParam().sigma, 3, DoubtfulBeams(GetParam(), 1.57, 3.0)),
            kMaxWrongDraws);
}

TEST_P(NoiseTest, ObtuseCornerOf135Degrees) {
  const PlanarWorld world = PlanarWorld().AddWalls({{-3, 2}, {1, 2}, {4, -1}});
  const PlanarWorldScan scan =
      TakePlanarWorldScan(world, {0, 0}, 1.2, GetParam().num_beams, kFieldOfView);
  EXPECT_LE(CountWrongDraws(scan, GetParam().sigma, 3, DoubtfulBeams(GetParam(), 0.78, 2.2)),
            kMaxWrongDraws);
}

TEST_P(NoiseTest, GentleCornerOf170Degrees) {
  const double bend = 10.0 * M_PI / 180.0;
  const PlanarWorld world = PlanarWorld().AddWalls(
      {{-4, 2}, {0.5, 2}, {0.5 + 4 * std::cos(bend), 2 - 4 * std::sin(bend)}});
  const PlanarWorldScan scan =
      TakePlanarWorldScan(world, {0, 0}, 1.57, GetParam().num_beams, kFieldOfView);
  EXPECT_LE(CountWrongDraws(scan, GetParam().sigma, 3, DoubtfulBeams(GetParam(), bend, 2.0)),
            kMaxWrongDraws);
}

TEST_P(NoiseTest, DepthJumpAtConvexCornerLosesNoBeam) {
  const PlanarWorld world =
      PlanarWorld().AddWalls({{-3, 2}, {1, 2}, {1, 6}}).AddWalls({{-3, 7}, {6, 7}});
  const PlanarWorldScan scan =
      TakePlanarWorldScan(world, {0, 0}, 1.3, GetParam().num_beams, kFieldOfView);
  EXPECT_LE(CountWrongDraws(scan, GetParam().sigma, 0, 0), kMaxWrongDraws);
}

TEST_P(NoiseTest, CorridorSeenAtGrazingIncidence) {
  const PlanarWorld world =
      PlanarWorld().AddWalls({{-15, -1}, {14, -1}, {14, 1.2}, {-15, 1.2}});
  const PlanarWorldScan scan =
      TakePlanarWorldScan(world, {0, 0}, 0.0, GetParam().num_beams, kFieldOfView);
  ASSERT_GE(TrueRuns(scan).size(), 2u);  // the far end has four of 90 beams
  EXPECT_LE(CountWrongDraws(scan, GetParam().sigma, 3, 6), kMaxWrongDraws);
}

// A flat pillar in front of a wall: a run of beams nearer by `offset`.
PlanarWorld WallWithPillar(double half_width, double offset) {
  return PlanarWorld().AddWalls({{-3, 2},
                                 {-half_width, 2},
                                 {-half_width, 2 - offset},
                                 {half_width, 2 - offset},
                                 {half_width, 2},
                                 {3, 2}});
}

TEST(SegmentationTest, PillarFiveSigmaBeforeTheWall) {
  const PlanarWorldScan scan =
      TakePlanarWorldScan(WallWithPillar(0.4, 0.05), {0, 0}, 1.57, 270, kFieldOfView);
  EXPECT_LE(CountWrongDraws(scan, 0.01, 1, 2), kMaxWrongDraws);
}

// Runs of beams off the line by up to two sigma, which no test of single beams can see. The
// run of n beams in the middle of a wall of 3 n has a chi square of 2 n (offset / sigma)^2 /
// 3, here 450. Harder: a line through the run and the wall on one side of it has one of 2 n
// (offset / sigma)^2 / 16 only, here 85, and has to be told from two walls that meet there,
// for which 21 are asked: a failure would be 3.5 sigma away.
TEST(SegmentationTest, LongRunsTwoSigmaOffTheWall) {
  constexpr double kOffset = 0.06;
  const PlanarWorldScan scan =
      TakePlanarWorldScan(WallWithPillar(0.85, kOffset), {0, 0}, 1.57, 1080, kFieldOfView);
  const std::vector<std::pair<int, int>> runs = TrueRuns(scan);
  ASSERT_EQ(runs.size(), 3u);
  ASSERT_NEAR(runs[1].second - runs[1].first + 1, 170, 25);
  std::mt19937_64 random(42);
  int num_wrong = 0;
  for (int draw = 0; draw < 500; ++draw) {
    const auto segments = SegmentScanLine(
        AddRangeNoise(scan.scan_line, 0.03, &random), MakeScanner(0.03), {}, {});
    // No segment holds more of another surface than chance explains: a run of n beams goes
    // to the wrong side with the probability of a normal variable > sqrt(n) offset / sigma
    // / 2.
    const int tolerance = static_cast<int>(std::pow(2.0 * 3.9 * 0.03 / kOffset, 2));
    bool is_right = segments.size() >= 2 && segments.size() <= 3;
    for (const Segment& segment : segments) {
      bool is_on_one = false;
      for (const auto& run : runs) {
        is_on_one = is_on_one || (segment.first_beam >= run.first - tolerance &&
                                  segment.last_beam <= run.second + tolerance);
      }
      is_right = is_right && is_on_one;
    }
    num_wrong += is_right ? 0 : 1;
  }
  EXPECT_LE(num_wrong, kMaxWrongDraws);
}

// The mean errors of all lines, over draws of noise, are zero; their variances are the stated
// ones. Bounds: four standard errors of a mean (1 / sqrt(n)) and of a variance (sqrt(2 / n)).
TEST_P(NoiseTest, LinesOfARoomAreUnbiasedAndConsistent) {
  const PlanarWorld world = RectangularRoom();
  const double heading = 0.2;
  const PlanarWorldScan scan =
      TakePlanarWorldScan(world, {0, 0}, heading, GetParam().num_beams, kFieldOfView);
  const size_t num_walls = TrueRuns(scan).size();  // the last has four of 90 beams
  ASSERT_GE(num_walls, 3u);
  constexpr int kDraws = 2500;
  Eigen::Array<double, 4, 1> offset = Eigen::Array4d::Zero(), direction = offset;
  Eigen::Array<double, 4, 1> squares = offset;
  std::mt19937_64 random(7);
  int num_draws = 0;
  double chi2 = 0.0;
  double degrees = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto segments =
        SegmentScanLine(AddRangeNoise(scan.scan_line, GetParam().sigma, &random),
                        MakeScanner(GetParam().sigma),
                        {},
                        {});
    if (segments.size() != num_walls) continue;
    ++num_draws;
    for (int wall = 0; wall < static_cast<int>(num_walls); ++wall) {
      const Segment& segment = segments[static_cast<size_t>(wall)];
      const WhitenedError error(segment, LineOfWall(world, wall, {0, 0}, heading));
      offset(wall) += error.offset;
      direction(wall) += error.direction;
      squares(wall) += error.offset * error.offset + error.direction * error.direction;
      chi2 += segment.chi2;
      degrees += segment.num_points - 2;
    }
  }
  ASSERT_GE(num_draws, kDraws - 5 * kMaxWrongDraws);
  const double four_standard_errors = 4.0 / std::sqrt(num_draws);
  for (int wall = 0; wall < static_cast<int>(num_walls); ++wall) {
    EXPECT_NEAR(offset(wall) / num_draws, 0.0, four_standard_errors) << wall;
    EXPECT_NEAR(direction(wall) / num_draws, 0.0, four_standard_errors) << wall;
    // Normalised estimation error squared: chi square with two degrees, variance 4.
    EXPECT_NEAR(squares(wall) / num_draws, 2.0, 2.0 * four_standard_errors) << wall;
  }
  EXPECT_NEAR(chi2 / degrees, 1.0, 4.0 * std::sqrt(2.0 / degrees));
}

TEST_P(NoiseTest, SegmentsOfARoundColumnAreShort) {
  PlanarWorld world;
  world.columns.push_back({{2, 0}, 0.3});
  const PlanarWorldScan scan =
      TakePlanarWorldScan(world, {0, 0}, 0.0, GetParam().num_beams, kFieldOfView);
  std::mt19937_64 random(42);
  for (int draw = 0; draw < 100; ++draw) {
    for (const Segment& segment :
         SegmentScanLine(AddRangeNoise(scan.scan_line, GetParam().sigma, &random),
                         MakeScanner(GetParam().sigma),
                         {},
                         {})) {
      EXPECT_LT(segment.length_m(), 0.6);
    }
  }
}

TEST(SegmentationTest, RandomClutterHasNoLongSegments) {
  std::mt19937_64 random(42);
  std::uniform_real_distribution<double> range(1.0, 6.0);
  int num_points = 0;
  constexpr int kDraws = 100;
  constexpr int kBeams = 1080;
  for (int draw = 0; draw < kDraws; ++draw) {
    ScanLine scan_line;
    scan_line.angle_min = -0.5 * kFieldOfView;
    scan_line.angle_increment = kFieldOfView / kBeams;
    for (int i = 0; i < kBeams; ++i)
      scan_line.ranges.push_back(static_cast<float>(range(random)));
    for (const Segment& segment : SegmentScanLine(scan_line, MakeScanner(0.03), {}, {})) {
      EXPECT_LE(segment.num_points, 12);
      num_points += segment.num_points;
    }
  }
  EXPECT_LT(num_points, kDraws * kBeams / 100);
}

TEST(SegmentationTest, ExactRangesGiveExactLines) {
  const PlanarWorld world = RectangularRoom();
  const PlanarWorldScan scan = TakePlanarWorldScan(world, {0.3, -0.2}, 0.2, 270, kFieldOfView);
  const auto segments = SegmentScanLine(scan.scan_line, MakeScanner(0.03), {}, {});
  ASSERT_EQ(segments.size(), 4u);
  for (int wall = 0; wall < 4; ++wall) {
    const Segment& segment = segments[static_cast<size_t>(wall)];
    const TrueLine truth = LineOfWall(world, wall, {0.3, -0.2}, 0.2);
    EXPECT_NEAR(segment.distance, truth.normal.dot(truth.point), 2e-6);
    EXPECT_NEAR((segment.normal - truth.normal).norm(), 0.0, 2e-6);
    EXPECT_LT(segment.distance, 0.0);
    EXPECT_NEAR(segment.chi2, 0.0, 1e-4);
    EXPECT_NEAR(segment.normal.dot(segment.centroid), segment.distance, 1e-12);
    EXPECT_NEAR(segment.normal.dot(segment.start), segment.distance, 1e-12);
    EXPECT_NEAR(segment.normal.dot(segment.end), segment.distance, 1e-12);
  }
}

// A wall straight ahead, sums by hand: points (d, d tan a), weight (cos a / sigma)^-2.
TEST(SegmentationTest, StatisticsOfAWallByHand) {
  const double d = 2.0;
  const double sigma = 0.01;
  Scanner scanner = MakeScanner(sigma);
  scanner.angle_noise_rad = 0.002;
  ScanLine scan_line;
  scan_line.angle_min = -0.1;
  scan_line.angle_increment = 0.05;
  double weights = 0.0, first = 0.0, second = 0.0;
  for (int i = 0; i < 15; ++i) {
    const double angle = scan_line.BeamAngle(i);
    const double range = d / std::cos(angle);
    scan_line.ranges.push_back(static_cast<float>(range));
    const double variance = std::pow(sigma * std::cos(angle), 2) +
                            std::pow(range * scanner.angle_noise_rad * std::sin(angle), 2);
    weights += 1.0 / variance;
    first += d * std::tan(angle) / variance;
    second += std::pow(d * std::tan(angle), 2) / variance;
  }
  const auto segments = SegmentScanLine(scan_line, scanner, {}, {});
  ASSERT_EQ(segments.size(), 1u);
  const double mean = first / weights;
  const double spread = std::sqrt(second / weights - mean * mean);
  EXPECT_EQ(segments[0].num_points, 15);
  EXPECT_NEAR(segments[0].distance, -d, 1e-6);
  EXPECT_NEAR(segments[0].centroid.y(), mean, 1e-6);
  EXPECT_NEAR(segments[0].spread_m, spread, 1e-6);
  EXPECT_NEAR(segments[0].sigma_offset_m, 1.0 / std::sqrt(weights), 1e-9);
  EXPECT_NEAR(segments[0].sigma_direction_rad, 1.0 / std::sqrt(weights) / spread, 1e-9);
}

TEST(SegmentationTest, MotionIsTakenOut) {
  const PlanarWorld world = RectangularRoom();
  ScannerMotion motion;
  motion.yaw_rate_rad_s = 0.5 * M_PI;
  motion.velocity_m_s = {1.2, -0.4};
  const Vector2d position(0.3, -0.2);
  const PlanarWorldScan scan =
      TakePlanarWorldScan(world, position, 0.2, 270, kFieldOfView, 0.075, motion);
  const auto segments = SegmentScanLine(scan.scan_line, MakeScanner(0.01), motion, {});
  ASSERT_EQ(segments.size(), 4u);
  for (int wall = 0; wall < 4; ++wall) {
    const Segment& segment = segments[static_cast<size_t>(wall)];
    const TrueLine truth = LineOfWall(world, wall, position, 0.2);
    EXPECT_NEAR(segment.distance, truth.normal.dot(truth.point), 1e-5);
    EXPECT_NEAR((segment.normal - truth.normal).norm(), 0.0, 1e-5);
  }
  // Without it the walls are off by many times what 1 cm of noise explains.
  const auto skewed = SegmentScanLine(scan.scan_line, MakeScanner(0.01), {}, {});
  ASSERT_FALSE(skewed.empty());
  const WhitenedError error(skewed[0], LineOfWall(world, 0, position, 0.2));
  EXPECT_GT(std::hypot(error.offset, error.direction), 10.0);
}

}  // namespace
}  // namespace plumbline
