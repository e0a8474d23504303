#include "simulation/sensing/recorder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/util/time.h"
#include "test/testing/test_files.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1400000000000000000;

// A walk of 2 s through a hall with two scanners that have no noise.
Experiment Hall() {
  Experiment experiment;
  FloorPlan plan;
  plan.ceiling_height = 3.0;
  plan.outlines = {{{0, 0}, {20, 0}, {20, 8}, {0, 8}}};
  experiment.building = MakeBuilding(plan);
  Scanner scanner;
  scanner.name = "left";
  scanner.topic = "/left";
  scanner.body_from_scanner.translation = {0.0, 0.1, 0.0};
  experiment.rig.scanners.push_back(scanner);
  scanner.name = "right";
  scanner.topic = "/right";
  scanner.body_from_scanner = {RotationFromRollPitchYaw(0, 0, M_PI / 2), {0.0, -0.2, 0.0}};
  experiment.rig.scanners.push_back(scanner);
  experiment.scanner_phases_s = {0.0, 0.0};
  experiment.noise.scale = 0.0;
  experiment.path.way_points = {{{2, 4}, ""}, {{4, 4}, ""}};
  experiment.path.start_ns = kStart;
  return experiment;
}

FaultOptions Faults(const std::string& text) {
  return ReadFaults(YamlNode::ReadText(text, "e.yaml"), Hall().rig);
}

// The lines that the recording has of one scanner.
std::vector<ScanLine> Recorded(const Experiment& experiment, int scanner, uint64_t seed = 1) {
  std::vector<ScanLine> lines;
  Recorder recorder(experiment, seed);
  Simulator(experiment, seed).Run([&](const PerfectScanLine& perfect) {
    const std::optional<ScanLine> line = recorder.Record(perfect);
    if (line && line->scanner_index == scanner) lines.push_back(*line);
  });
  return lines;
}

std::vector<ScanLine> RecordedWith(const std::string& faults, int scanner) {
  Experiment experiment = Hall();
  experiment.faults = Faults(faults);
  return Recorded(experiment, scanner);
}

TEST(Faults, ErrorsNameFileAndLine) {
  EXPECT_EQ(ErrorOf([] { Faults("outliers: 2"); }),
            "e.yaml:1: 'outliers' must lie between 0 and 1, not 2");
  EXPECT_EQ(ErrorOf([] { Faults("glass: {returns: 0.7, passes: 0.4}"); }),
            "e.yaml:1: returns and passes are probabilities that exclude each other");
  EXPECT_EQ(ErrorOf([] { Faults("swapped: [left]"); }), "e.yaml:1: name two scanners");
  EXPECT_NE(ErrorOf([] { Faults("scanners:\n  - {name: top}"); }), "");
}

TEST(Faults, BiasIsAddedToEveryRange) {
  const std::vector<ScanLine> right = Recorded(Hall(), 0);
  const std::vector<ScanLine> biased =
      RecordedWith("scanners: [{name: left, range_bias_m: 0.25}]", 0);
  ASSERT_EQ(biased.size(), right.size());
  for (size_t i = 0; i < biased[5].ranges.size(); ++i) {
    EXPECT_NEAR(biased[5].ranges[i], right[5].ranges[i] + 0.25, 1e-5);
  }
}

TEST(Faults, ScaleMultipliesEveryRange) {
  const std::vector<ScanLine> right = Recorded(Hall(), 0);
  const std::vector<ScanLine> scaled =
      RecordedWith("scanners: [{name: left, range_scale: 1.01}]", 0);
  for (size_t i = 0; i < scaled[5].ranges.size(); ++i) {
    EXPECT_NEAR(scaled[5].ranges[i], 1.01 * right[5].ranges[i], 1e-3);
  }
}

TEST(Faults, FeetAreFeet) {
  const std::vector<ScanLine> right = Recorded(Hall(), 1);
  const std::vector<ScanLine> feet = RecordedWith("scanners: [{name: right, unit: feet}]", 1);
  for (size_t i = 0; i < feet[5].ranges.size(); ++i) {
    EXPECT_NEAR(feet[5].ranges[i] * 0.3048, right[5].ranges[i], 1e-5);
  }
}

TEST(Faults, LateClockShowsWhereTheRigWas) {
  const std::vector<ScanLine> right = Recorded(Hall(), 0);
  const std::vector<ScanLine> late =
      RecordedWith("scanners: [{name: left, clock_late_s: 0.05}]", 0);
  // What is stamped with line 10 was taken two periods earlier.
  EXPECT_EQ(late[8].stamp_ns, right[10].stamp_ns);
  EXPECT_EQ(late[8].ranges, right[8].ranges);
}

TEST(Faults, MirroredBeamsComeInTheOtherOrder) {
  const std::vector<ScanLine> right = Recorded(Hall(), 0);
  const std::vector<ScanLine> mirrored =
      RecordedWith("scanners: [{name: left, mirrored: true}]", 0);
  const ScanLine& line = mirrored[0];
  for (size_t i = 0; i < 270; ++i) {
    // The rig moves by up to 2 cm while the mirror turns.
    EXPECT_NEAR(line.ranges[i], right[0].ranges[269 - i], 0.15);
  }
  // To the right of the path, where the walls are farther from this scanner.
  EXPECT_NEAR(line.ranges[225], 4.1, 0.01);
  EXPECT_NEAR(right[0].ranges[225], 3.9, 0.01);
}

TEST(Faults, RigFileGoesOnSayingWhatItSaid) {
  Experiment experiment = Hall();
  experiment.faults = Faults(
      "scanners: [{name: left, rotation_error_deg: [0, 0, 90], "
      "translation_error_m: [0.5, 0, 0]}]");
  const Rig rig = TrueRig(experiment.rig, experiment.faults);
  EXPECT_LT(
      (rig.scanners[0].body_from_scanner.translation - Eigen::Vector3d(0.5, 0.1, 0)).norm(),
      1e-12);
  const Eigen::Vector3d forward =
      rig.scanners[0].body_from_scanner.rotation * Eigen::Vector3d::UnitX();
  EXPECT_LT((forward - Eigen::Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_EQ(experiment.rig.scanners[0].body_from_scanner.translation.x(), 0.0);
  // The middle beam looks to the left.
  EXPECT_NEAR(Recorded(experiment, 0)[0].ranges[134], 3.9, 0.01);
}

TEST(Faults, SwappedScannersHaveEachOthersPlace) {
  Experiment experiment = Hall();
  const ScanLine left = Recorded(experiment, 0)[3];
  const ScanLine right = Recorded(experiment, 1)[3];
  experiment.faults = Faults("swapped: [right, left]");
  EXPECT_EQ(Recorded(experiment, 0)[3].ranges, right.ranges);
  EXPECT_EQ(Recorded(experiment, 1)[3].ranges, left.ranges);
}

TEST(Faults, EpisodesBeginAndEnd) {
  const auto episode = [](const std::string& kind) {
    return RecordedWith(
        "scanners: [{name: left, episodes: [{kind: " + kind + ", from_s: 0.5, to_s: 1}]}]", 0);
  };
  const std::vector<ScanLine> right = Recorded(Hall(), 0);
  ASSERT_EQ(right.size(), 80u);
  const std::vector<ScanLine> gone = episode("gone");
  ASSERT_EQ(gone.size(), 60u);
  EXPECT_EQ(gone[20].stamp_ns, kStart + 1000000000);

  const std::vector<ScanLine> frozen = episode("frozen");
  ASSERT_EQ(frozen.size(), 80u);
  EXPECT_EQ(frozen[19].ranges, right[19].ranges);
  EXPECT_EQ(frozen[39].ranges, right[19].ranges);
  EXPECT_EQ(frozen[39].stamp_ns, right[39].stamp_ns);
  EXPECT_EQ(frozen[40].ranges, right[40].ranges);

  const std::vector<ScanLine> infinite = episode("infinite");
  for (const float range : infinite[25].ranges) EXPECT_TRUE(std::isinf(range));

  const std::vector<ScanLine> random = episode("random");
  double sum = 0.0;
  for (const float range : random[25].ranges) sum += range;
  // Uniform between 0.1 and 30 m, four standard deviations of the mean of 270.
  EXPECT_NEAR(sum / 270, 15.05, 4 * 29.9 / std::sqrt(12.0 * 270));
  EXPECT_EQ(random[40].ranges, right[40].ranges);
}

TEST(Faults, OutliersHaveTheirShare) {
  const std::vector<ScanLine> right = Recorded(Hall(), 0);
  const std::vector<ScanLine> outliers = RecordedWith("outliers: 0.1", 0);
  int num_changed = 0;
  for (size_t line = 0; line < right.size(); ++line) {
    for (size_t i = 0; i < 270; ++i) {
      num_changed += outliers[line].ranges[i] != right[line].ranges[i];
    }
  }
  const double num_beams = 270.0 * static_cast<double>(right.size());
  EXPECT_NEAR(num_changed, 0.1 * num_beams, 4 * std::sqrt(0.09 * num_beams));
}

TEST(Faults, MixedPixelsLieBetweenTheSidesOfAnEdge) {
  Experiment experiment = Hall();
  FloorPlan plan;
  plan.ceiling_height = 3.0;
  plan.outlines = {{{0, 0}, {20, 0}, {20, 8}, {0, 8}}};
  plan.solids = {{{6, 4.5}, {7, 4.5}, {7, 5.5}, {6, 5.5}}};
  experiment.building = MakeBuilding(plan);
  const std::vector<ScanLine> right = Recorded(experiment, 0);
  experiment.faults = Faults("mixed_pixels: 1");
  const std::vector<ScanLine> mixed = Recorded(experiment, 0);
  int num_mixed = 0;
  for (size_t line = 0; line < right.size(); ++line) {
    for (size_t i = 0; i + 1 < 270; ++i) {
      const float a = right[line].ranges[i];
      const float b = right[line].ranges[i + 1];
      if (mixed[line].ranges[i] == a) continue;
      ++num_mixed;
      EXPECT_GT(std::abs(a - b), 0.1f);
      EXPECT_GE(mixed[line].ranges[i], std::min(a, b));
      EXPECT_LE(mixed[line].ranges[i], std::max(a, b));
    }
  }
  EXPECT_GE(num_mixed, static_cast<int>(right.size()));
}

TEST(Faults, GlassReturnsPassesOrSwallows) {
  Experiment experiment = Hall();
  FloorPlan plan;
  plan.ceiling_height = 3.0;
  plan.outlines = {{{0, 0}, {20, 0}, {20, 8}, {0, 8}}};
  plan.furniture = {{Furniture::Kind::kBox, {10, 7}, {19, 0.01, 3}, 0.0, 0.0, true}};
  experiment.building = MakeBuilding(plan);
  experiment.faults = Faults("glass: {returns: 0.3, passes: 0.5}");
  int num_pane = 0, num_wall = 0, num_lost = 0;
  Simulator(experiment, 5).Run([&](const PerfectScanLine& line) {
    if (line.scan_line.scanner_index != 0) return;
    for (size_t i = 200; i < 250; ++i) {  // 65 to 115 degrees to the left
      const std::optional<RayHit>& hit = line.beams[i];
      const double angle = line.scan_line.BeamAngle(static_cast<int>(i));
      if (!hit) {
        ++num_lost;
      } else if (std::abs(hit->range * std::sin(angle) - 3.9) < 1e-6) {
        ++num_wall;
      } else {
        EXPECT_NEAR(hit->range * std::sin(angle), 2.895, 1e-6);
        ++num_pane;
      }
    }
  });
  const double n = num_pane + num_wall + num_lost;
  ASSERT_EQ(n, 80 * 50);
  EXPECT_NEAR(num_pane / n, 0.3, 4 * std::sqrt(0.21 / n));
  EXPECT_NEAR(num_wall / n, 0.5, 4 * std::sqrt(0.25 / n));
}

TEST(Faults, PeopleHideWallsAndAreNoTruth) {
  Experiment experiment = Hall();
  Person person;
  person.circles_m = 1.0;
  experiment.moving.people = {person};
  int num_hidden = 0;
  Simulator(experiment).Run([&](const PerfectScanLine& line) {
    for (const std::optional<RayHit>& hit : line.beams) {
      if (hit->face_id != kNoFace) continue;
      ++num_hidden;
      EXPECT_NEAR(hit->range, 1.0, 0.45);
    }
  });
  // Of 20 cm radius at 1 m: about 23 degrees.
  EXPECT_GT(num_hidden, 80 * 2 * 12);
}

}  // namespace
}  // namespace plumbline
