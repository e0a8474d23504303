#include "core/mapping/map_job.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "core/options/config.h"
#include "core/result/result_reader.h"
#include "core/result/result_writer.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

class MapJobTest : public MappingTest {
 protected:
  Scenario Base() const {
    Scenario scenario;
    scenario.building = TrapezoidRoom();
    scenario.scanners = TiltedRig();
    scenario.path = TrapezoidWalk(2.0, 1.0);
    return scenario;
  }
};

TEST_F(MapJobTest, ProgressGoesFromNothingToAllAndNeverBack) {
  WriteRecording(Simulate(Base()));
  std::vector<double> shares;
  RunMapJob(Job("", 2), [&](double share_done) { shares.push_back(share_done); });
  ASSERT_FALSE(shares.empty());
  EXPECT_LT(shares.front(), 0.05);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1.0);
}

TEST_F(MapJobTest, ProgressNamesTheStagesAndKnowsTheRecording) {
  const SimulatedRecording recording = Simulate(Base());
  WriteRecording(recording);
  std::vector<std::string> stages;
  std::set<double> lengths_s;
  RunMapJob(Job("", 1), [&](const ProgressState& state) {
    if (stages.empty() || stages.back() != state.stage) stages.emplace_back(state.stage);
    lengths_s.insert(state.recording_s);
  });
  EXPECT_EQ(stages, (std::vector<std::string>{"following", "estimating", "writing"}));
  ASSERT_EQ(lengths_s.size(), 1u);
  EXPECT_NEAR(*lengths_s.begin(),
              SecondsBetween(recording.scan_lines.front().stamp_ns,
                             recording.scan_lines.back().stamp_ns),
              0.05);
}

TEST_F(MapJobTest, SummaryAgreesWithTheOtherFiles) {
  const SimulatedRecording recording = Simulate(Base());
  WriteRecording(recording);
  const Summary summary = Map();
  int64_t num_points = 0;
  for (const ScanLine& scan_line : recording.scan_lines) {
    const Scanner& scanner =
        recording.rig.scanners[static_cast<size_t>(scan_line.scanner_index)];
    for (const float range : scan_line.ranges)
      num_points += scanner.IsValidRange(range) ? 1 : 0;
  }
  EXPECT_EQ(summary.points, num_points);
  EXPECT_LE(summary.points_used, summary.points);
  const std::vector<PlanePatch> planes = ReadPlanes(Path("result/planes.json"));
  EXPECT_EQ(summary.planes, static_cast<int>(planes.size()));
  int64_t plane_points = 0;
  int plane_segments = 0;
  bool has_reference = false;
  for (const PlanePatch& plane : planes) {
    plane_points += plane.num_points;
    plane_segments += plane.num_segments;
    EXPECT_NEAR(plane.SignedDistance(plane.centre), 0.0, 1e-6);
    EXPECT_GE(plane.outline.size(), 3u);
    EXPECT_LT(plane.first_time_ns, plane.last_time_ns);
    if (plane.id != summary.reference_plane_id) continue;
    has_reference = true;
    EXPECT_LT((plane.normal - Eigen::Vector3d::UnitX()).norm(), 1e-9);
  }
  EXPECT_TRUE(has_reference);
  EXPECT_EQ(summary.points_used, plane_points);
  EXPECT_EQ(summary.segments, plane_segments);
  const std::vector<StampedPose> poses = ReadTrajectory(Path("result/trajectory.tum"));
  EXPECT_EQ(summary.scans, static_cast<int>(poses.size()));
  EXPECT_EQ(poses.size(), recording.scan_lines.size() / 3);
  EXPECT_LT(poses.front().world_from_body.translation.norm(), 1e-6) << "the origin";
  EXPECT_EQ(summary.motion, "spatial");
  EXPECT_TRUE(summary.warnings.empty());
  // The range noise, times the cosine of the incidence angles.
  EXPECT_LT(summary.residual_rms_m, 0.02);
  EXPECT_GT(summary.residual_rms_m, 0.5 * 0.02);
  const nlohmann::json json =
      nlohmann::json::parse(std::ifstream(Path("result/summary.json")));
  EXPECT_EQ(json.at("points").get<int64_t>(), num_points);
  EXPECT_EQ(ReadStartTime(Path("result/summary.json")), recording.scan_lines.front().stamp_ns);
  EXPECT_EQ(json.at("motion"), "spatial");
}

TEST_F(MapJobTest, ConfigUsedGivesTheSameResultAgain) {
  WriteRecording(Simulate(Base()));
  Map("window: {num_scans: 12}\nplanes: {min_scans: 3}\n");
  const std::string config = ReadBytes(Path("result/config_used.yaml"));
  EXPECT_EQ(ReadMapperOptions(Path("result/config_used.yaml")).window.num_scans, 12);
  const std::string trajectory = ReadBytes(Path("result/trajectory.tum"));
  Map(config);
  EXPECT_EQ(ReadBytes(Path("result/config_used.yaml")), config);
  EXPECT_TRUE(ReadBytes(Path("result/trajectory.tum")) == trajectory);
}

// It is the map's origin, whose position nobody measures; directions are measured there, too.
TEST_F(MapJobTest, TheFirstPositionIsHeld) {
  WriteRecording(Simulate(Base()));
  Map();
  std::istringstream file(ReadBytes(Path("result/trajectory_covariance.csv")));
  std::string line;
  std::getline(file, line);
  for (const bool is_first : {true, false}) {
    std::getline(file, line);
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream values(line);
    double time_s = 0.0;
    values >> time_s;
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) {
        double value = -1.0;
        values >> value;
        if (i == j) {
          EXPECT_EQ(value == 0.0, is_first && i < 3) << line;
        } else if (is_first && i < 3) {
          EXPECT_EQ(value, 0.0) << line;
        }
      }
    }
  }
}

TEST_F(MapJobTest, NoiseLeftToTheRecordingIsThatOfItsBeams) {
  SimulatedRecording recording = Simulate(Base());
  WriteRecording(recording);
  const double true_noise_m = recording.rig.scanners[0].range_noise_m;
  for (Scanner& scanner : recording.rig.scanners) scanner.estimates_noise = true;
  WriteRig(recording.rig, Path("rig.yaml"));
  Map();
  for (const Scanner& scanner : ReadRig(Path("result/rig_used.yaml")).scanners) {
    EXPECT_FALSE(scanner.estimates_noise);
    EXPECT_NEAR(scanner.range_noise_m, true_noise_m, 0.1 * true_noise_m) << scanner.name;
    EXPECT_NE(scanner.range_noise_m, true_noise_m);
  }
}

TEST_F(MapJobTest, LeavesNothingButTheResult) {
  WriteRecording(Simulate(Base()));
  Map();
  std::set<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(Path("result"))) {
    files.insert(entry.path().filename().string());
  }
  EXPECT_EQ(files,
            (std::set<std::string>{"config_used.yaml",
                                   "loop_closures.json",
                                   "map.pcd",
                                   "map.ply",
                                   "plane_covariance.csv",
                                   "planes.json",
                                   "planes.ply",
                                   "rig_used.yaml",
                                   "summary.json",
                                   "trajectory.tum",
                                   "trajectory_covariance.csv"}));
}

}  // namespace
}  // namespace plumbline
