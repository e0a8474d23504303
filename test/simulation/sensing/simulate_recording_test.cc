#include "simulation/sensing/simulate_recording.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "core/result/result_reader.h"
#include "core/result/result_writer.h"
#include "core/sensor/recording.h"
#include "test/testing/paths.h"
#include "test/testing/test_files.h"

namespace plumbline {
namespace {

const std::string kConfigs = ConfigsDir();
const std::string kRoom = kConfigs + "/experiments/room.yaml";

std::string Simulate(uint64_t seed, const std::string& name) {
  const std::string directory = testing::TempDir() + "simulate_recording/" + name;
  SimulateRecording(kRoom, seed, directory, [](double) {});
  return directory;
}

std::string Content(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

TEST(SimulateRecording, SummaryAgreesWithTheFiles) {
  const std::string directory = testing::TempDir() + "simulate_recording/summary";
  std::vector<double> shares;
  const SimulationSummary summary =
      SimulateRecording(kRoom, 1, directory, [&](const ProgressState& state) {
        shares.push_back(state.share_done);
        EXPECT_GT(state.recording_s, 10.0);
      });
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1.0);
  RecordingReader reader(directory + "/recording.bag", ReadRig(directory + "/rig.yaml"));
  EXPECT_EQ(summary.num_scan_lines, reader.num_scan_lines());
  EXPECT_EQ(summary.num_scanners, 3);
  EXPECT_EQ(summary.num_beams, 270 * summary.num_scan_lines);
  const std::vector<StampedPose> poses = ReadTrajectory(directory + "/truth_trajectory.tum");
  EXPECT_NEAR(
      summary.duration_s, SecondsBetween(poses.front().time_ns, poses.back().time_ns), 1e-6);
  EXPECT_EQ(summary.num_faces,
            static_cast<int>(ReadPlanes(directory + "/truth_planes.json").size()));
  // 0.9 m/s all the way.
  EXPECT_NEAR(summary.path_length_m, 0.9 * summary.duration_s, 0.1);
  const std::string table = SimulationTable(summary, directory);
  EXPECT_NE(table.find(std::to_string(summary.num_beams) + "\n"), std::string::npos);
  EXPECT_NE(table.find("Written to " + directory + ": recording.bag"), std::string::npos);
}

// An experiment with wheels: the recording and its rig file have their topic.
TEST(SimulateRecording, OdometryIsRecorded) {
  std::string text = Content(kRoom);
  for (const char* name : {"building: ", "rig: "}) {
    text.replace(
        text.find(name + std::string("..")), std::string(name).size() + 2, name + kConfigs);
  }
  const std::string experiment =
      WriteTestFile("wheels.yaml", text + "odometry: {topic: /wheels, length_scale: 1.5}\n");
  const std::string directory = testing::TempDir() + "simulate_recording/wheels";
  SimulateRecording(experiment, 1, directory, [](double) {});
  const Rig rig = ReadRig(directory + "/rig.yaml");
  EXPECT_EQ(rig.odometry_topic, "/wheels");
  const RecordingReader reader(directory + "/recording.bag", rig);
  const std::shared_ptr<const Odometry> odometry = reader.odometry();
  ASSERT_NE(odometry, nullptr);
  const Path path(ReadExperiment(experiment).path);
  const int64_t begin_ns = path.start_ns() + NanosecondsFromSeconds(1.0);
  const int64_t end_ns = begin_ns + NanosecondsFromSeconds(0.1);
  const std::optional<PlanarMotion> motion = odometry->Between(begin_ns, end_ns);
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->translation.norm(),
              1.5 * (path.TravelledAt(end_ns) - path.TravelledAt(begin_ns)),
              1e-3);
  EXPECT_EQ(ReadRig(Simulate(1, "no_wheels") + "/rig.yaml").odometry_topic, "");
}

TEST(SimulateRecording, RecordingAndTruthFitTogether) {
  const std::string directory = Simulate(1, "fit");
  const Rig rig = ReadRig(directory + "/rig.yaml");
  const std::vector<StampedPose> poses = ReadTrajectory(directory + "/truth_trajectory.tum");
  const std::vector<PlanePatch> planes = ReadPlanes(directory + "/truth_planes.json");
  const Simulator simulator(ReadExperiment(kRoom));
  RecordingReader reader(directory + "/recording.bag", rig);
  EXPECT_EQ(reader.num_scan_lines(), simulator.num_scan_lines());
  EXPECT_EQ(poses.front().time_ns, reader.start_ns());
  EXPECT_GT(poses.back().time_ns, reader.end_ns());

  int64_t points = 0;
  for (const PlanePatch& plane : planes) points += plane.num_points;
  EXPECT_EQ(planes.size(), 6u + 2u + 4u);
  // Points of the recording lie on the planes of the truth, up to the noise: the pose is
  // taken from the path, and the plane is the nearest one.
  int64_t valid = 0;
  ScanLine line;
  double square = 0.0;
  int64_t checked = 0;
  while (reader.Next(&line)) {
    const Scanner& scanner = rig.scanners[static_cast<size_t>(line.scanner_index)];
    for (int beam = 0; beam < line.num_beams(); ++beam) {
      const double range = line.ranges[static_cast<size_t>(beam)];
      if (!scanner.IsValidRange(range)) continue;
      ++valid;
      if (valid % 100 != 0) continue;
      const Eigen::Vector2d xy = range * line.BeamDirection(beam);
      const Eigen::Vector3d p_world = simulator.path().PoseAt(line.BeamTime(beam)) *
                                      scanner.body_from_scanner *
                                      Eigen::Vector3d(xy.x(), xy.y(), 0.0);
      double nearest = 1e9;
      for (const PlanePatch& plane : planes) {
        nearest = std::min(nearest, std::abs(plane.SignedDistance(p_world)));
      }
      square += nearest * nearest;
      ++checked;
    }
  }
  EXPECT_EQ(valid, points);
  // Noise of 3 cm along the beam, across the plane times the cosine of the incidence angle: of
  // 70 degrees a third, and few beams meet a plane as flatly.
  EXPECT_LT(std::sqrt(square / static_cast<double>(checked)), 0.03);
  EXPECT_GT(std::sqrt(square / static_cast<double>(checked)), 0.01);
}

TEST(SimulateRecording, SameSeedSameBytes) {
  const std::string a = Simulate(7, "a");
  const std::string b = Simulate(7, "b");
  const std::string c = Simulate(8, "c");
  for (const char* file :
       {"/recording.bag", "/rig.yaml", "/truth_trajectory.tum", "/truth_planes.json"}) {
    EXPECT_EQ(Content(a + file), Content(b + file)) << file;
    EXPECT_FALSE(Content(a + file).empty()) << file;
  }
  EXPECT_NE(Content(a + "/recording.bag"), Content(c + "/recording.bag"));
}

TEST(SimulateRecording, UnwritableDirectoryIsNamed) {
  const std::string file = WriteTestFile("file", "x");
  EXPECT_EQ(ErrorOf([&] { SimulateRecording(kRoom, 1, file + "/sub", [](double) {}); }),
            file + "/sub: can not create the directory");
}

// A mesh's triangles may face either way.
TEST(TruthPlanes, FaceTheSideFromWhichTheyWereSeen) {
  Building building;
  Face& face = building.faces.emplace_back();
  face.normal = Eigen::Vector3d::UnitX();
  face.distance = 2.0;
  face.outline = {{2, 0, 0}, {2, 1, 0}, {2, 1, 1}};
  face.triangles = {{face.outline[0], face.outline[1], face.outline[2]}};
  TruthPlanes truth(building);
  PerfectScanLine perfect;
  const RayHit behind{1.0, 0, true, false};
  perfect.beams = {RayHit{1.0, 0, false, false},
                   behind,
                   behind,
                   RayHit{0.5, kNoFace, false, false},
                   std::nullopt};
  ScanLine recorded;
  recorded.ranges = {1.0f, 1.0f, 1.0f, 0.5f, std::numeric_limits<float>::infinity()};
  truth.Add(perfect, recorded, 0.0);
  const std::vector<PlanePatch> patches = truth.Patches();
  ASSERT_EQ(patches.size(), 1u);
  EXPECT_EQ(patches[0].num_points, 3);
  EXPECT_EQ(patches[0].normal, Eigen::Vector3d(-1, 0, 0));
  EXPECT_EQ(patches[0].distance, -2.0);
  EXPECT_EQ(patches[0].outline.front(), Eigen::Vector3d(2, 1, 1));
}

}  // namespace
}  // namespace plumbline
