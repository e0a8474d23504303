// What a map says of itself: one of a right rig agrees with its scans, one of a rig whose file
// is wrong says so, and names the scanner.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "test/testing/scenario.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

class VerdictTest : public MappingTest {
 protected:
  SimulatedRecording SimulateRoom() {
    Scenario scenario;
    scenario.building = TrapezoidRoom();
    scenario.scanners = TiltedRig();
    scenario.path = TrapezoidWalk(6.0, 1.0);
    return Simulate(scenario);
  }
};

TEST_F(VerdictTest, ARightRigIsConsistent) {
  WriteRecording(SimulateRoom());
  const Summary summary = Map();
  EXPECT_EQ(summary.consistency.verdict, Verdict::kConsistent);
  EXPECT_TRUE(summary.consistency.doubtful_intervals.empty());
  EXPECT_LT(summary.consistency.contradicted_share, 0.05);
}

TEST_F(VerdictTest, ATurnedScannerIsNamed) {
  SimulatedRecording recording = SimulateRoom();
  Scanner& scanner = recording.rig.scanners[1];
  scanner.body_from_scanner.rotation =
      scanner.body_from_scanner.rotation *
      Eigen::AngleAxisd(10.0 * M_PI / 180.0, Eigen::Vector3d::UnitZ());
  WriteRecording(recording);
  const Summary summary = Map();
  EXPECT_NE(summary.consistency.verdict, Verdict::kConsistent);
  ASSERT_FALSE(summary.consistency.doubtful_intervals.empty());
  const auto names_it = [&](const std::string& warning) {
    return warning.find("scanner " + scanner.name) != std::string::npos;
  };
  EXPECT_TRUE(std::any_of(summary.warnings.begin(), summary.warnings.end(), names_it));
}

}  // namespace
}  // namespace plumbline
