#include <gtest/gtest.h>

#include <ostream>

#include "test/testing/scenario.h"

namespace plumbline {
namespace {

struct RoomCase {
  const char* name;
  Scenario scenario;
};

std::vector<ScenarioScanner> Rig(int beams, double scan_rate_hz, double range_noise_m) {
  std::vector<ScenarioScanner> scanners = TiltedRig();
  for (ScenarioScanner& scanner : scanners) {
    scanner.beams = beams;
    scanner.scan_rate_hz = scan_rate_hz;
    scanner.range_noise_m = range_noise_m;
  }
  return scanners;
}

std::vector<ScenarioScanner> WithOffsets(std::vector<ScenarioScanner> scanners) {
  scanners[1].time_offset_s = -0.012;
  scanners[2].time_offset_s = 0.031;
  return scanners;
}

std::vector<ScenarioScanner> WithRates(std::vector<ScenarioScanner> scanners) {
  scanners[0].scan_rate_hz = 25.0;
  scanners[1].scan_rate_hz = 20.0;
  scanners[2].scan_rate_hz = 15.0;
  return scanners;
}

std::vector<RoomCase> RoomCases() {
  const std::string phases = "scanner_phases_s: [0.0, 0.017, 0.034]\n";
  const std::string automatic = "automatic";
  return {
      {"HexagonWith90Beams",
       {HexagonalRoom(), Rig(90, 40.0, 0.02), automatic, HexagonWalk(6.0, 0.8), "", ""}},
      {"HexagonWith540BeamsAt10Hz",
       {HexagonalRoom(), Rig(540, 10.0, 0.02), automatic, HexagonWalk(6.0, 0.7), "", ""}},
      {"TrapezoidAt75Hz",
       {TrapezoidRoom(), Rig(180, 75.0, 0.03), automatic, TrapezoidWalk(5.0, 1.0), "", ""}},
      {"TrapezoidWith1080Beams",
       {TrapezoidRoom(), Rig(1080, 20.0, 0.01), automatic, TrapezoidWalk(5.0, 1.0), "", ""}},
      {"PillarAt20Hz",
       {PillarRoom(), Rig(270, 20.0, 0.03), automatic, PillarWalk(8.0, 1.0), "", ""}},
      {"PillarWithTimeOffsets",
       {PillarRoom(),
        WithOffsets(Rig(180, 20.0, 0.02)),
        automatic,
        PillarWalk(8.0, 1.0),
        phases,
        ""}},
      {"TrapezoidWithMixedRatesAndDropouts",
       {TrapezoidRoom(),
        WithRates(Rig(270, 20.0, 0.02)),
        automatic,
        TrapezoidWalk(5.0, 1.0),
        "noise: {dropout: 0.1}\n",
        ""}},
  };
}

// For the test's name.
void PrintTo(const RoomCase& room_case, std::ostream* out) { *out << room_case.name; }

class RoomTest : public MappingTest, public testing::WithParamInterface<RoomCase> {};

TEST_P(RoomTest, FindsExactlyTheTruePlanes) {
  const Scenario& scenario = GetParam().scenario;
  const Evaluation evaluation = Run(scenario);
  EXPECT_EQ(summary_.motion, "spatial");
  ExpectTruePlanes(evaluation);
  ExpectPreciseTrajectory(evaluation, scenario, summary_);
}

INSTANTIATE_TEST_SUITE_P(Rooms,
                         RoomTest,
                         testing::ValuesIn(RoomCases()),
                         [](const auto& info) { return std::string(info.param.name); });

// Twice around a corridor, no wall of which is in view all the way: what is known of the
// second round pulls on the first one only as far as both agree.
TEST_F(MappingTest, TheSecondRoundAgreesWithTheFirst) {
  Scenario scenario;
  scenario.building =
      "floor_height_m: 0.0\nceiling_height_m: 3.0\noutlines:\n"
      "  - corners: [[0.0, 0.0], [16.0, 0.0], [16.0, 9.0], [0.0, 9.0]]\n"
      "solids:\n"
      "  - corners: [[2.5, 2.2], [13.0, 2.2], [13.0, 6.9], [2.5, 6.9]]\n";
  scenario.scanners = Rig(180, 20.0, 0.02);
  scenario.path =
      "path:\n"
      "  way_points: [[7.0, 1.1], [14.5, 1.1], [14.5, 8.0], [1.2, 8.0], [1.2, 1.1]]\n"
      "  closed: true\n  laps: 2.1\n  corner_radius_m: 0.6\n  body_height_m: 1.4\n"
      "speed_m_s: 1.2\n";
  const Evaluation evaluation = Run(scenario, 3);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  ExpectTruePlanes(evaluation);
  ExpectPreciseTrajectory(evaluation, scenario, summary_);
}

}  // namespace
}  // namespace plumbline
