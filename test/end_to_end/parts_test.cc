// A recording with a long gap falls into two maps; where the second one shows the same room,
// it is found in the frame of the first without an initial pose.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/result/result_reader.h"
#include "core/util/time.h"
#include "simulation/evaluation/evaluation.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

constexpr double kDegree = M_PI / 180.0;

class PartsTest : public MappingTest {
 protected:
  SimulatedRecording SimulateWithGap(const std::string& building, const std::string& path) {
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
                                 return s > 8.0 && s < 10.5;
                               }),
                lines.end());
    WriteRecording(recording);
    return recording;
  }

  // The heading of a part's model frame and its origin in the building's frame.
  Rigid3d TruthFromModel(const std::string& folder, const SimulatedRecording& recording) {
    EvaluationInput input;
    input.trajectory = ReadTrajectory(Path(folder + "/trajectory.tum"));
    input.planes = ReadPlanes(Path(folder + "/planes.json"));
    input.figures.reference_plane_id = 0;
    input.truth_trajectory = recording.truth_trajectory;
    input.truth_planes = recording.truth_planes;
    return Evaluate(input, {}).frame.model_from_truth.Inverse();
  }
};

TEST_F(PartsTest, OfOneRoomArePlacedInOneFrame) {
  const SimulatedRecording recording =
      SimulateWithGap(HexagonalRoom(), HexagonWalk(14.0, 0.8));
  const Summary summary = Map();
  ASSERT_EQ(summary.parts.size(), 2u);
  const bool first_is_longest = summary.parts[0].folder == ".";
  const PartSummary& other = summary.parts[first_is_longest ? 1 : 0];
  ASSERT_TRUE(other.pose.has_value());
  const Rigid3d longest_from_other = TruthFromModel("result", recording).Inverse() *
                                     TruthFromModel("result/" + other.folder, recording);
  const double yaw = std::atan2(longest_from_other.rotation.toRotationMatrix()(1, 0),
                                longest_from_other.rotation.toRotationMatrix()(0, 0));
  EXPECT_LT(std::abs(std::remainder(other.pose->yaw_deg * kDegree - yaw, 2.0 * M_PI)), 0.01);
  EXPECT_NEAR(other.pose->x_m, longest_from_other.translation.x(), 0.05);
  EXPECT_NEAR(other.pose->y_m, longest_from_other.translation.y(), 0.05);
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
