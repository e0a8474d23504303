#include "simulation/sensing/simulator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "core/util/time.h"
#include "test/testing/test_files.h"

namespace plumbline {
namespace {

// A straight walk through a hall of 40 x 8 m, 3 m high, with one scanner.
Experiment Hall() {
  Experiment experiment;
  FloorPlan plan;
  plan.ceiling_height = 3.0;
  plan.outlines = {{{0, 0}, {40, 0}, {40, 8}, {0, 8}}};
  experiment.building = MakeBuilding(plan);
  Scanner scanner;
  scanner.name = "top";
  scanner.topic = "/top";
  experiment.rig.scanners = {scanner};
  experiment.scanner_phases_s = {0.0};
  experiment.path.way_points = {{{2, 4}, "e.yaml:3"}, {{12, 4}, "e.yaml:4"}};
  experiment.path.start_ns = 1400000000000000000;
  experiment.path.location = "e.yaml:2";
  return experiment;
}

std::vector<PerfectScanLine> RunAll(const Experiment& experiment) {
  std::vector<PerfectScanLine> lines;
  Simulator(experiment).Run([&](const PerfectScanLine& line) { lines.push_back(line); });
  return lines;
}

TEST(Simulator, BeamsHaveTheTimesAndDirectionsOfTheMirror) {
  const std::vector<PerfectScanLine> lines = RunAll(Hall());
  ASSERT_EQ(lines.size(), 400u);  // 10 m at 1 m/s and 40 Hz
  const ScanLine& line = lines[7].scan_line;
  EXPECT_EQ(line.stamp_ns, 1400000000000000000 + 7 * 25000000);
  EXPECT_EQ(lines[7].beams.size(), 270u);
  // 270 of 360 degrees of the period of 25 ms; float precision.
  EXPECT_NEAR(line.time_increment_s * 270, 0.025 * 0.75, 1e-9);
  EXPECT_NEAR(line.BeamAngle(0), -134.5 * M_PI / 180, 1e-6);
  EXPECT_NEAR(line.BeamAngle(269), 134.5 * M_PI / 180, 1e-5);
  EXPECT_EQ(line.angle_increment, static_cast<float>(line.angle_increment));
}

// Ranges that follow from the geometry: every beam from where the rig is at its own time.
TEST(Simulator, PerfectRangesComputedByHand) {
  const double offset_s = 0.004;
  Experiment experiment = Hall();
  experiment.rig.scanners[0].body_from_scanner.translation = {0.1, 0.2, 0.0};
  experiment.rig.scanners[0].time_offset_s = offset_s;
  experiment.path.speed_m_s = 2.0;
  const std::vector<PerfectScanLine> lines = RunAll(experiment);
  ASSERT_GT(lines.size(), 100u);
  for (const PerfectScanLine& line : {lines.front(), lines[100]}) {
    const double stamp_s = SecondsBetween(experiment.path.start_ns, line.scan_line.stamp_ns);
    for (int beam = 0; beam < 270; ++beam) {
      const double time_s = stamp_s + beam * line.scan_line.time_increment_s + offset_s;
      const Eigen::Vector2d origin(2.1 + 2.0 * time_s, 4.2);
      const Eigen::Vector2d direction = line.scan_line.BeamDirection(beam);
      const double along = ((direction.x() > 0 ? 40 : 0) - origin.x()) / direction.x();
      const double across = ((direction.y() > 0 ? 8 : 0) - origin.y()) / direction.y();
      const std::optional<RayHit>& hit = line.beams[static_cast<size_t>(beam)];
      ASSERT_TRUE(hit);
      // Beam times are rounded to a nanosecond.
      ASSERT_NEAR(hit->range, std::min(along, across), 1e-7);
    }
  }
}

TEST(Simulator, ScanLinesComeInOrderOfTheirStamps) {
  Experiment experiment = Hall();
  Scanner slow = experiment.rig.scanners[0];
  slow.scan_rate_hz = 7.5;
  slow.time_offset_s = -0.03;
  experiment.rig.scanners.push_back(slow);
  experiment.scanner_phases_s = {0.0, 0.025};
  int counts[2] = {0, 0};
  int64_t last_stamp = 0;
  int last_scanner = 0;
  for (const PerfectScanLine& line : RunAll(experiment)) {
    EXPECT_GE(line.scan_line.stamp_ns, last_stamp);
    if (line.scan_line.stamp_ns == last_stamp) {
      EXPECT_GT(line.scan_line.scanner_index, last_scanner);
    }
    last_stamp = line.scan_line.stamp_ns;
    last_scanner = line.scan_line.scanner_index;
    ++counts[last_scanner];
  }
  EXPECT_EQ(counts[0], 400);
  // 10 s hold 74 whole periods after 25 ms; the first begins 5 ms before the path.
  EXPECT_EQ(counts[1], 73);
}

TEST(Simulator, NoiseHasTheScannersStandardDeviation) {
  const Experiment experiment = Hall();
  const Scanner& scanner = experiment.rig.scanners[0];
  double sum = 0.0, square = 0.0, neighbours = 0.0;
  int count = 0;
  double last = 0.0;
  for (const PerfectScanLine& line : RunAll(experiment)) {
    const ScanLine noisy = AddNoise(line, scanner, NoiseOptions(), 5);
    for (size_t i = 0; i < noisy.ranges.size(); ++i) {
      if (!std::isfinite(noisy.ranges[i])) continue;
      const double error = (noisy.ranges[i] - line.beams[i]->range) / scanner.range_noise_m;
      sum += error;
      square += error * error;
      neighbours += error * last;
      last = error;
      ++count;
    }
  }
  ASSERT_GT(count, 90000);
  // Four standard deviations of each statistic.
  EXPECT_LT(std::abs(sum / count), 4 / std::sqrt(count));
  EXPECT_LT(std::abs(square / count - 1), 4 * std::sqrt(2.0 / count));
  EXPECT_LT(std::abs(neighbours / count), 4 / std::sqrt(count));
}

TEST(Simulator, NoiseCanBeSwitchedOff) {
  const Experiment experiment = Hall();
  NoiseOptions off;
  off.scale = 0.0;
  const PerfectScanLine line = RunAll(experiment)[0];
  const ScanLine scan_line = AddNoise(line, experiment.rig.scanners[0], off, 5);
  for (size_t i = 0; i < scan_line.ranges.size(); ++i) {
    if (line.beams[i]->range > 30.0) {
      EXPECT_TRUE(std::isinf(scan_line.ranges[i]));
    } else {
      EXPECT_EQ(scan_line.ranges[i], static_cast<float>(line.beams[i]->range));
    }
  }
}

TEST(Simulator, RangesBeyondTheLimitsAreNoReturns) {
  Experiment experiment = Hall();
  experiment.rig.scanners[0].max_range_m = 10.0;
  int lost = 0;
  for (const PerfectScanLine& line : RunAll(experiment)) {
    const ScanLine noisy = AddNoise(line, experiment.rig.scanners[0], NoiseOptions(), 5);
    for (size_t i = 0; i < noisy.ranges.size(); ++i) {
      if (std::isinf(noisy.ranges[i])) {
        EXPECT_GT(line.beams[i]->range, 10.0 - 6 * 0.03);
        ++lost;
      } else {
        EXPECT_LE(noisy.ranges[i], 10.0f);
      }
    }
  }
  EXPECT_GT(lost, 1000);
}

TEST(Simulator, DropoutLosesItsShareAndLeavesTheOthers) {
  const Experiment experiment = Hall();
  NoiseOptions noise;
  noise.dropout = 0.2;
  int lost = 0;
  int count = 0;
  for (const PerfectScanLine& line : RunAll(experiment)) {
    const ScanLine all = AddNoise(line, experiment.rig.scanners[0], NoiseOptions(), 5);
    const ScanLine some = AddNoise(line, experiment.rig.scanners[0], noise, 5);
    for (size_t i = 0; i < all.ranges.size(); ++i) {
      if (!std::isfinite(all.ranges[i])) continue;
      ++count;
      if (std::isfinite(some.ranges[i])) {
        EXPECT_EQ(some.ranges[i], all.ranges[i]);
      } else {
        ++lost;
      }
    }
  }
  EXPECT_LT(std::abs(static_cast<double>(lost) / count - 0.2), 4 * std::sqrt(0.16 / count));
}

TEST(Simulator, SeedsDecideTheNoise) {
  const Experiment experiment = Hall();
  const std::vector<PerfectScanLine> lines = RunAll(experiment);
  const Scanner& scanner = experiment.rig.scanners[0];
  EXPECT_EQ(AddNoise(lines[3], scanner, NoiseOptions(), 5).ranges,
            AddNoise(RunAll(experiment)[3], scanner, NoiseOptions(), 5).ranges);
  EXPECT_NE(AddNoise(lines[3], scanner, NoiseOptions(), 5).ranges,
            AddNoise(lines[3], scanner, NoiseOptions(), 6).ranges);
}

TEST(Simulator, TooShortAPathIsAnError) {
  Experiment experiment = Hall();
  experiment.path.length_m = 0.01;
  EXPECT_EQ(ErrorOf([&] { Simulator simulator(experiment); }),
            "e.yaml:2: the path is too short for a single scan line");
}

}  // namespace
}  // namespace plumbline
