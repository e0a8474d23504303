#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "core/segmentation/segmentation.h"
#include "core/sensor/scanner_motion.h"
#include "test/core/segmentation/segmentation_fixture.h"
#include "test/testing/planar_world.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;

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

}  // namespace
}  // namespace plumbline
