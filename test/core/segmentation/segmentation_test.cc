#include "core/segmentation/segmentation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "core/sensor/scanner_motion.h"
#include "core/util/quantiles.h"
#include "test/testing/planar_world.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;

constexpr double kFieldOfView = 1.5 * M_PI;

struct Setting {
  int num_beams;
  double sigma;
};

Scanner MakeScanner(double sigma) {
  Scanner scanner;
  scanner.range_noise_m = sigma;
  scanner.angle_noise_rad = 0.0;
  return scanner;
}

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// A wall in the scanner frame: through `point`, `normal` towards the scanner.
struct TrueLine {
  Vector2d point;
  Vector2d normal;
};

TrueLine LineOfWall(const PlanarWorld& world,
                    int wall,
                    const Vector2d& position,
                    double heading) {
  const Eigen::Rotation2Dd scanner_from_world(-heading);
  const Vector2d start =
      scanner_from_world * (world.walls[static_cast<size_t>(wall)].start - position);
  const Vector2d end =
      scanner_from_world * (world.walls[static_cast<size_t>(wall)].end - position);
  const Vector2d along = (end - start).normalized();
  Vector2d normal(-along.y(), along.x());
  if (normal.dot(start) > 0.0) normal = -normal;
  return {start, normal};
}

// Errors of a segment's line in units of the standard deviations that it states.
struct WhitenedError {
  WhitenedError(const Segment& segment, const TrueLine& truth)
      : offset(truth.normal.dot(segment.centroid - truth.point) / segment.sigma_offset_m),
        direction(
            std::atan2(Cross(truth.normal, segment.normal), truth.normal.dot(segment.normal)) /
            segment.sigma_direction_rad) {}
  double offset;
  double direction;
};

PlanarWorld RectangularRoom() {
  return PlanarWorld().AddWalls({{-3, -2}, {5, -2}, {5, 3}, {-3, 3}, {-3, -2}});
}

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

// With the stated significance of 1e-4 per scan line and the tests of every segment's chi
// square a draw goes wrong with a probability below 1e-3: 5 of 500 has a probability below
// 2e-4.
constexpr int kMaxWrongDraws = 5;

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

ScanLine WallAhead(int num_beams) {
  return TakePlanarWorldScan(
             PlanarWorld().AddWalls({{2, -30}, {2, 30}}), {0, 0}, 0.0, num_beams, 2.0)
      .scan_line;
}

TEST(SegmentationTest, SingleOutliersAndMissingReturnsAreExcluded) {
  ScanLine scan_line = WallAhead(200);
  scan_line.ranges[2] = 1.0f;  // where the line would start
  scan_line.ranges[40] = 0.7f;
  scan_line.ranges[41] = 0.7f;
  scan_line.ranges[90] = std::numeric_limits<float>::quiet_NaN();
  scan_line.ranges[91] = std::numeric_limits<float>::infinity();
  scan_line.ranges[120] = 0.0f;
  scan_line.ranges[121] = -1.0f;
  scan_line.ranges[150] = 31.0f;
  const auto segments = SegmentScanLine(scan_line, MakeScanner(0.03), {}, {});
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_EQ(segments[0].excluded_beams, (std::vector<int>{2, 40, 41, 90, 91, 120, 121, 150}));
  EXPECT_EQ(segments[0].first_beam, 0);
  EXPECT_EQ(segments[0].last_beam, 199);
  EXPECT_EQ(segments[0].num_points, 192);
  EXPECT_NEAR(segments[0].distance, -2.0, 1e-5);
}

// What little a line meets of other surfaces behind an opening is not its own.
TEST(SegmentationTest, AFewBeamsBeyondMoreOfOthersAreLeftOut) {
  for (const bool more_beyond : {false, true}) {
    ScanLine scan_line = WallAhead(200);
    for (size_t i = 196; i < (more_beyond ? 198 : 199); ++i) scan_line.ranges[i] = 1.0f;
    const auto segments = SegmentScanLine(scan_line, MakeScanner(0.03), {}, {});
    ASSERT_EQ(segments.size(), 1u);
    EXPECT_EQ(segments[0].first_beam, 0);
    EXPECT_EQ(segments[0].last_beam, more_beyond ? 199 : 195);
  }
}

TEST(SegmentationTest, OpeningAndOccluderPartAWall) {
  for (const float range : {8.0f, 1.0f, std::numeric_limits<float>::infinity()}) {
    ScanLine scan_line = WallAhead(200);
    for (size_t i = 80; i < 100; ++i) scan_line.ranges[i] = range;
    std::vector<Segment> on_wall;
    for (const Segment& segment : SegmentScanLine(scan_line, MakeScanner(0.01), {}, {})) {
      if (std::abs(segment.distance + 2.0) < 1e-4) on_wall.push_back(segment);
    }
    ASSERT_EQ(on_wall.size(), 2u) << range;
    EXPECT_EQ(on_wall[0].first_beam, 0);
    EXPECT_EQ(on_wall[0].last_beam, 79);
    EXPECT_EQ(on_wall[1].first_beam, 100);
    EXPECT_EQ(on_wall[1].last_beam, 199);
  }
}

// Near the maximum range only beams with negative noise return; they must not count.
TEST(SegmentationTest, MaximumRangeDoesNotBias) {
  Scanner scanner = MakeScanner(0.03);
  scanner.max_range_m = 3.0;
  const PlanarWorldScan scan = TakePlanarWorldScan(
      PlanarWorld().AddWalls({{2, -0.5}, {2, 30}}), {0, 0}, 0.0, 1080, kFieldOfView);
  const TrueLine truth{{2, 0}, {-1, 0}};
  std::mt19937_64 random(7);
  double offset = 0.0;
  double direction = 0.0;
  int num_draws = 0;
  for (int draw = 0; draw < 2000; ++draw) {
    const auto segments =
        SegmentScanLine(AddRangeNoise(scan.scan_line, 0.03, &random), scanner, {}, {});
    if (segments.size() != 1) continue;
    const WhitenedError error(segments[0], truth);
    offset += error.offset;
    direction += error.direction;
    ++num_draws;
  }
  ASSERT_GE(num_draws, 2000 - 4 * kMaxWrongDraws);
  EXPECT_NEAR(offset / num_draws, 0.0, 4.0 / std::sqrt(num_draws));
  EXPECT_NEAR(direction / num_draws, 0.0, 4.0 / std::sqrt(num_draws));
}

// Around the scanner, corners at random distances: walls of a few beams up to a hundred.
PlanarWorld RandomPolygon(std::mt19937_64* random) {
  std::uniform_real_distribution<double> distance(1.0, 4.0);
  const int num_corners = std::uniform_int_distribution<int>(3, 60)(*random);
  std::vector<Vector2d> corners;
  for (int i = 0; i < num_corners; ++i) {
    const double angle = 2.0 * M_PI * i / num_corners;
    corners.push_back(distance(*random) * Vector2d(std::cos(angle), std::sin(angle)));
  }
  corners.push_back(corners.front());
  return PlanarWorld().AddWalls(corners);
}

// Errors about as large as what the segmentation takes for an outlier, no returns, and ranges
// the scanner can not measure.
void AddFaults(double sigma, std::mt19937_64* random, ScanLine* scan_line) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (float& range : scan_line->ranges) {
    const double fault = uniform(*random);
    const double error = sigma * (3.5 + 3.0 * uniform(*random));
    if (fault < 0.12) range += static_cast<float>(error);
    if (fault > 0.12 && fault < 0.24) range -= static_cast<float>(error);
    if (fault > 0.95) range = std::numeric_limits<float>::quiet_NaN();
    if (fault > 0.97) range = std::numeric_limits<float>::infinity();
    if (fault > 0.99) range = 0.02f;
  }
}

void ExpectConsistent(const std::vector<Segment>& segments,
                      const ScanLine& scan_line,
                      const Scanner& scanner) {
  int previous = -1;
  for (const Segment& segment : segments) {
    ASSERT_GT(segment.first_beam, previous);
    ASSERT_LT(segment.last_beam, scan_line.num_beams());
    previous = segment.last_beam;
    std::vector<int> counting;
    auto excluded = segment.excluded_beams.begin();
    for (int i = segment.first_beam; i <= segment.last_beam; ++i) {
      if (excluded != segment.excluded_beams.end() && *excluded == i) {
        ++excluded;
      } else {
        counting.push_back(i);
        ASSERT_TRUE(scanner.IsValidRange(scan_line.ranges[static_cast<size_t>(i)])) << i;
      }
    }
    // All of them met in order: sorted, without repetition, inside the segment.
    ASSERT_TRUE(excluded == segment.excluded_beams.end());
    ASSERT_EQ(segment.num_points, static_cast<int>(counting.size()));
    ASSERT_GE(segment.num_points, SegmentationOptions().min_points);
    ASSERT_EQ(counting.front(), segment.first_beam);
    ASSERT_EQ(counting.back(), segment.last_beam);
    ASSERT_LT(segment.distance, 0.0);
    ASSERT_NEAR(segment.normal.norm(), 1.0, 1e-12);
    for (const Vector2d& point : {segment.start, segment.end, segment.centroid}) {
      ASSERT_NEAR(segment.normal.dot(point), segment.distance, 1e-9);
    }
    ASSERT_GE(segment.chi2, -1e-6);
    for (const double positive : {segment.spread_m,
                                  segment.sigma_offset_m,
                                  segment.sigma_direction_rad,
                                  segment.length_m()}) {
      ASSERT_TRUE(std::isfinite(positive) && positive > 0.0) << positive;
    }
  }
}

class ConsistencyTest : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(NumbersOfBeams,
                         ConsistencyTest,
                         testing::Values(90, 270, 1080, 1440));

TEST_P(ConsistencyTest, SegmentsOfRandomScenesDoNotContradictThemselves) {
  std::mt19937_64 random(42);
  std::uniform_real_distribution<double> rate(-2.0, 2.0);
  int num_segments = 0;
  for (int scene = 0; scene < 30; ++scene) {
    const ScannerMotion motion{{rate(random), rate(random)}, rate(random)};
    Scanner scanner;
    if (scene % 3 == 1) scanner.max_range_m = 2.5;
    if (scene % 3 == 2) scanner.min_range_m = 2.0;
    const PlanarWorldScan scan = TakePlanarWorldScan(
        RandomPolygon(&random), {0, 0}, 0.0, GetParam(), kFieldOfView, 0.075, motion);
    for (int draw = 0; draw < 20; ++draw) {
      ScanLine noisy = AddRangeNoise(scan.scan_line, scanner.range_noise_m, &random);
      AddFaults(scanner.range_noise_m, &random, &noisy);
      const auto segments = SegmentScanLine(noisy, scanner, motion, {});
      ExpectConsistent(segments, noisy, scanner);
      if (HasFatalFailure()) FAIL() << "scene " << scene << ", draw " << draw;
      num_segments += static_cast<int>(segments.size());
    }
  }
  EXPECT_GE(num_segments, 600);
}

// A noise level stated too low must not make all lines vanish.
TEST(SegmentationTest, UnderstatedNoiseKeepsTheWalls) {
  const PlanarWorldScan scan =
      TakePlanarWorldScan(RectangularRoom(), {0, 0}, 0.2, 1080, kFieldOfView);
  std::mt19937_64 random(42);
  const auto segments = SegmentScanLine(
      AddRangeNoise(scan.scan_line, 0.025, &random), MakeScanner(0.02), {}, {});
  ASSERT_EQ(segments.size(), 4u);
  EXPECT_NEAR(segments[0].chi2 / segments[0].num_points, 1.5625, 0.4);
}

TEST(SegmentationTest, ScansWithoutLinesGiveNoSegments) {
  ScanLine scan_line;
  scan_line.angle_increment = 0.01;
  const auto count = [&] {
    return SegmentScanLine(scan_line, MakeScanner(0.03), {}, {}).size();
  };
  EXPECT_EQ(count(), 0u);
  scan_line.ranges = {2.0f};
  EXPECT_EQ(count(), 0u);
  for (const float range : {std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity(),
                            0.0f,
                            -1.0f,
                            1e30f}) {
    scan_line.ranges.assign(270, range);
    EXPECT_EQ(count(), 0u) << range;
  }
  scan_line.ranges.assign(270, 2.0f);
  scan_line.angle_increment = 0.0;  // all beams in one direction determine no line
  EXPECT_EQ(count(), 0u);
}

TEST(SegmentationTest, SameInputGivesSameSegments) {
  const PlanarWorldScan scan =
      TakePlanarWorldScan(RectangularRoom(), {0, 0}, 0.2, 1080, kFieldOfView);
  std::mt19937_64 random(42);
  const ScanLine noisy = AddRangeNoise(scan.scan_line, 0.03, &random);
  const auto once = SegmentScanLine(noisy, MakeScanner(0.03), {}, {});
  const auto again = SegmentScanLine(noisy, MakeScanner(0.03), {}, {});
  ASSERT_EQ(once.size(), again.size());
  for (size_t k = 0; k < once.size(); ++k) {
    EXPECT_EQ(once[k].distance, again[k].distance);
    EXPECT_EQ(once[k].normal, again[k].normal);
    EXPECT_EQ(once[k].chi2, again[k].chi2);
  }
}

TEST(TwoSidedNormalQuantile, InvertsTheTailProbability) {
  for (const double probability : {0.9999, 0.5, 0.05, 1e-4, 1e-7, 1e-20, 1e-290}) {
    const double x = TwoSidedNormalQuantile(probability);
    EXPECT_NEAR(std::erfc(x * M_SQRT1_2) / probability, 1.0, 1e-12) << probability;
  }
  EXPECT_EQ(TwoSidedNormalQuantile(1.0), 0.0);
  EXPECT_GT(TwoSidedNormalQuantile(0.0), 36.0);
}

}  // namespace
}  // namespace plumbline
