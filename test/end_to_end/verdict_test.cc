// What a map says of itself: one of a right rig agrees with its scans, one of a rig whose file
// is wrong says so, and names the scanner.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/mapping/map_job.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class VerdictTest : public MappingTest {
 protected:
  SimulatedRecording SimulateRoom(uint64_t seed = 1) {
    Scenario scenario;
    scenario.building = TrapezoidRoom();
    scenario.scanners = TiltedRig();
    scenario.path = TrapezoidWalk(6.0, 1.0);
    return Simulate(scenario, seed);
  }
};

TEST_F(VerdictTest, ARightRigIsConsistent) {
  WriteRecording(SimulateRoom());
  const Summary summary = Map();
  EXPECT_EQ(summary.consistency.verdict, Verdict::kConsistent);
  EXPECT_TRUE(summary.consistency.doubtful_intervals.empty());
  EXPECT_LT(summary.consistency.contradicted_share, 0.05);
}

// Beams without times bend what a slow scanner sees; the scanners together show which they
// have.
TEST_F(VerdictTest, BeamTimesThatAreMissingAreTakenFromTheTurn) {
  Scenario scenario;
  scenario.building = TrapezoidRoom();
  scenario.scanners = TiltedRig();
  for (ScenarioScanner& scanner : scenario.scanners) {
    scanner.scan_rate_hz = 10.0;
    scanner.range_noise_m = 0.01;
  }
  scenario.path = TrapezoidWalk(6.0, 1.0);
  const SimulatedRecording right = Simulate(scenario);
  SimulatedRecording recording = right;
  for (ScanLine& line : recording.scan_lines) line.time_increment_s = 0.0;
  WriteRecording(recording);
  const Summary summary = Map();
  EXPECT_EQ(summary.consistency.verdict, Verdict::kConsistent);
  ASSERT_FALSE(summary.warnings.empty());
  EXPECT_THAT(summary.warnings.front(),
              AllOf(HasSubstr("time_increment is 0: the scanner turns once per scan line"),
                    HasSubstr("plumbline_map takes it so"),
                    HasSubstr("time_increment_s: ")));
  EXPECT_LT(EvaluateResult(right).trajectory.aligned.position_m.max, 0.02);
  // What was used stands in the result.
  EXPECT_TRUE(ReadRig(Path("result/rig_used.yaml")).scanners[0].time_increment_s);
}

// In so short a walk it is not named each time; the map is never taken for a right one.
TEST_F(VerdictTest, ATurnedScannerIsNamed) {
  constexpr int kNumRuns = 4;
  int num_named = 0;
  for (int run = 1; run <= kNumRuns; ++run) {
    SimulatedRecording recording = SimulateRoom(static_cast<uint64_t>(run));
    Scanner& scanner = recording.rig.scanners[1];
    scanner.body_from_scanner.rotation =
        scanner.body_from_scanner.rotation *
        Eigen::AngleAxisd(10.0 * M_PI / 180.0, Eigen::Vector3d::UnitZ());
    WriteRecording(recording);
    MapJob job = Job();
    EXPECT_THAT(ErrorOf([&] { RunMapJob(job, [](double) {}); }),
                AllOf(HasSubstr("recording.bag: a wrong map would come of it"),
                      HasSubstr("scanner " + scanner.name),
                      HasSubstr("--force")))
        << run;
    job.force = true;
    const Summary summary = RunMapJob(job, [](double) {});
    EXPECT_NE(summary.consistency.verdict, Verdict::kConsistent) << run;
    EXPECT_FALSE(summary.consistency.doubtful_intervals.empty()) << run;
    num_named += static_cast<int>(
        std::count_if(
            summary.warnings.begin(), summary.warnings.end(), [&](const std::string& warning) {
              return warning.find("scanner " + scanner.name) != std::string::npos;
            }) > 0);
  }
  EXPECT_GE(num_named, kNumRuns / 2);
}

}  // namespace
}  // namespace plumbline
