// A recording with a long gap is followed in two parts. Where the second one shows the same
// room, its place is found without an initial pose, and there is one map.

#include <gtest/gtest.h>

#include <algorithm>

#include "core/result/result_reader.h"
#include "core/util/time.h"
#include "simulation/evaluation/evaluation.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

class PartsTest : public MappingTest {
 protected:
  SimulatedRecording SimulateWithGap(const std::string& building,
                                     const std::string& path,
                                     double end_s = 10.5) {
    Scenario scenario;
    scenario.building = building;
    scenario.scanners = TiltedRig();
    scenario.path = path;
    SimulatedRecording recording = Simulate(scenario);
    const int64_t start_ns = recording.scan_lines.front().stamp_ns;
    auto& lines = recording.scan_lines;
    lines.erase(std::remove_if(lines.begin(),
                               lines.end(),
                               [&](const ScanLine& line) {
                                 const double s = SecondsBetween(start_ns, line.stamp_ns);
                                 return s > 8.0 && s < end_s;
                               }),
                lines.end());
    WriteRecording(recording);
    return recording;
  }
};

TEST_F(PartsTest, OfOneRoomAreOneMap) {
  const SimulatedRecording recording =
      SimulateWithGap(HexagonalRoom(), HexagonWalk(14.0, 0.8));
  const Summary summary = Map();
  EXPECT_TRUE(summary.parts.empty());
  ASSERT_EQ(summary.gaps.size(), 1u);
  EXPECT_NEAR(summary.gaps[0].start_s, 8.0, 0.1);
  EXPECT_NEAR(summary.gaps[0].end_s, 10.5, 0.1);
  EXPECT_EQ(summary.consistency.verdict, Verdict::kConsistent);
  EvaluationInput input;
  input.trajectory = ReadTrajectory(Path("result/trajectory.tum"));
  input.planes = ReadPlanes(Path("result/planes.json"));
  input.figures.reference_plane_id = 0;
  input.truth_trajectory = recording.truth_trajectory;
  input.truth_planes = recording.truth_planes;
  const Evaluation evaluation = Evaluate(input, {});
  EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 0.02);
  EXPECT_LT(evaluation.trajectory.aligned.rotation_deg.max, 0.5);
  EXPECT_EQ(input.planes.size(), recording.truth_planes.size());
  for (const StampedPose& pose : input.trajectory) {
    const double s = SecondsBetween(input.trajectory.front().time_ns, pose.time_ns);
    EXPECT_TRUE(s < 8.1 || s > 10.4) << "a pose in the gap, at " << s << " s";
  }
}

// The room has one curved wall, which both parts see.
TEST_F(PartsTest, OfOneRoomShareACurvedWall) {
  const SimulatedRecording recording = SimulateWithGap(
      "floor_height_m: 0.0\nceiling_height_m: 2.7\noutlines:\n"
      "  - corners: [[0.0, 0.0], [4.0, -1.2], [7.5, 0.5], [7.8, 4.2], "
      "{through: [4.4, 6.4], to: [0.3, 4.4]}]\n",
      HexagonWalk(14.0, 0.8));
  const Summary summary = Map();
  EXPECT_TRUE(summary.parts.empty());
  EXPECT_EQ(summary.gaps.size(), 1u);
  EXPECT_EQ(summary.consistency.verdict, Verdict::kConsistent);
  const std::vector<PlanePatch> surfaces = ReadPlanes(Path("result/planes.json"));
  EXPECT_EQ(surfaces.size(), recording.truth_planes.size());
  const auto is_curved = [](const PlanePatch& surface) {
    return surface.type == PlaneType::kCylinder;
  };
  EXPECT_EQ(std::count_if(surfaces.begin(), surfaces.end(), is_curved), 1);
}

// In six seconds the rig may have come to another room that looks like this one: two maps, and
// where the second one would lie by its walls.
TEST_F(PartsTest, OfOneRoomStayApartAfterALongGap) {
  SimulateWithGap(HexagonalRoom(), HexagonWalk(18.0, 0.8), 14.0);
  const Summary summary = Map();
  EXPECT_TRUE(summary.gaps.empty());
  ASSERT_EQ(summary.parts.size(), 2u);
  const bool first_is_longest = summary.parts[0].folder == ".";
  EXPECT_TRUE(summary.parts[first_is_longest ? 1 : 0].pose.has_value());
}

// Four walls are those of many a room.
TEST_F(PartsTest, OfARectangularRoomAreNot) {
  SimulateWithGap(
      "floor_height_m: 0.0\nceiling_height_m: 2.7\noutlines:\n"
      "  - corners: [[0.0, 0.0], [7.0, 0.0], [7.0, 5.0], [0.0, 5.0]]\n",
      HexagonWalk(14.0, 0.8));
  const Summary summary = Map();
  ASSERT_EQ(summary.parts.size(), 2u);
  for (const PartSummary& part : summary.parts) EXPECT_FALSE(part.pose.has_value());
  const auto says_so = [](const std::string& warning) {
    return warning.find("is not known") != std::string::npos;
  };
  EXPECT_TRUE(std::any_of(summary.warnings.begin(), summary.warnings.end(), says_so));
}

}  // namespace
}  // namespace plumbline
