#include "simulation/sensing/experiment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/sensor/rig.h"
#include "core/util/time.h"
#include "simulation/sensing/simulator.h"
#include "test/testing/paths.h"
#include "test/testing/test_files.h"

namespace plumbline {
namespace {

const std::string kConfigs = ConfigsDir();

std::vector<std::string> FilesIn(const std::string& folder, const std::string& ending) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(kConfigs + "/" + folder)) {
    if (entry.path().extension() == ending) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(Experiment, EveryShippedRigLoads) {
  for (const std::string& file : FilesIn("rigs", ".yaml")) {
    EXPECT_FALSE(ReadRig(file).scanners.empty());
  }
}

TEST(Experiment, EveryShippedBuildingLoads) {
  for (const std::string ending : {".yaml", ".ply"}) {
    EXPECT_GE(FilesIn("buildings", ending).size(), 3u);
    for (const std::string& file : FilesIn("buildings", ending)) {
      EXPECT_GE(ReadBuilding(file).faces.size(), 6u) << file;
    }
  }
}

// Also checks that the paths keep clear of the walls.
TEST(Experiment, EveryShippedExperimentLoads) {
  EXPECT_GE(FilesIn("experiments", ".yaml").size(), 6u);
  EXPECT_GE(FilesIn("experiments/robustness", ".yaml").size(), 25u);
  for (const std::string folder : {"experiments", "experiments/robustness"}) {
    for (const std::string& file : FilesIn(folder, ".yaml")) {
      EXPECT_GT(Simulator(ReadExperiment(file)).num_scan_lines(), 100) << file;
    }
  }
}

TEST(Experiment, OfficeIsAsLongAsThePapers) {
  const Simulator simulator(ReadExperiment(kConfigs + "/experiments/office.yaml"));
  EXPECT_EQ(simulator.num_scan_lines(), 3 * 3635);
  EXPECT_EQ(simulator.path().end_ns() - simulator.path().start_ns(), 90875000000);
}

// Planned paths keep to what a person can do, all along.
TEST(Experiment, WalksThroughHousesAreThoseOfAPerson) {
  for (const std::string name : {"fzk_stairs", "duplex_a_stairs"}) {
    const Path path(
        ReadExperiment(kConfigs + "/experiments/robustness/" + name + ".yaml").path);
    constexpr int64_t kStep = 10000000;
    for (int64_t time = path.start_ns(); time + kStep <= path.end_ns(); time += kStep) {
      const Rigid3d a = path.PoseAt(time);
      const Rigid3d b = path.PoseAt(time + kStep);
      // 0.9 m/s and the steps' bob of 0.23 m/s.
      ASSERT_LT((b.translation - a.translation).norm(), 1.2 * 0.01);
      // 60 deg/s and the swings' 17 and 21 deg/s.
      ASSERT_LT(a.rotation.angularDistance(b.rotation), 70 * M_PI / 180 * 0.01);
    }
  }
}

class ExperimentText : public testing::Test {
 protected:
  // Reads the text as an experiment beside the shipped building and rig; the message without
  // the path of the file.
  std::string Error(const std::string& text) {
    const std::string path = WriteTestFile("experiment.yaml", text);
    const std::string message = ErrorOf([&] { experiment_ = ReadExperiment(path); });
    if (message.empty()) return "";
    EXPECT_EQ(message.rfind(path + ":", 0), 0u) << message;
    return message.substr(std::min(path.size(), message.size()));
  }

  Experiment experiment_;
  const std::string files_ = "building: " + kConfigs +
                             "/buildings/room.yaml\nrig: " + kConfigs + "/rigs/paper.yaml\n";
  const std::string path_ =
      "path:\n  way_points: [[1, 1], [4, 1], [4, 3]]\n  corner_radius_m: 0.5\n"
      "  body_height_m: 1.5\n";
  const std::string all_ = files_ + path_ + "speed_m_s: 1\n";
};

TEST_F(ExperimentText, ReadsEveryKey) {
  EXPECT_EQ(
      Error(all_ + "motion:\n  roll: {amplitude_deg: 3, frequency_hz: 2, phase_deg: 90}\n"
                   "  height: {amplitude_m: 0.1, frequency_hz: 1}\n"
                   "noise: {scale: 0.5, dropout: 0.1}\nstart_time_s: 5\n"
                   "scanner_phases_s: [0, 0.001, 0.002]\nmapper: {anything: goes}\n"),
      "");
  EXPECT_NEAR(experiment_.path.roll.amplitude, 3 * M_PI / 180, 1e-15);
  EXPECT_EQ(experiment_.path.roll.frequency_hz, 2.0);
  EXPECT_NEAR(experiment_.path.roll.phase_rad, M_PI / 2, 1e-15);
  EXPECT_EQ(experiment_.path.height.amplitude, 0.1);
  EXPECT_EQ(experiment_.path.pitch.amplitude, 0.0);
  EXPECT_EQ(experiment_.noise.scale, 0.5);
  EXPECT_EQ(experiment_.noise.dropout, 0.1);
  EXPECT_EQ(experiment_.path.start_ns, 5000000000);
  EXPECT_EQ(experiment_.scanner_phases_s, (std::vector<double>{0, 0.001, 0.002}));
}

TEST_F(ExperimentText, ReadsWalks) {
  const std::string way =
      "path:\n  way_points: [[1, 1], [4, 1], [1, 1]]\n  corner_radius_m: 0.3\n"
      "  body_height_m: 1.5\n  max_turn_rate_deg_s: 45\n  length_m: 4\n  start_fraction: "
      "0.25\n"
      "  pauses: [{at_m: 1, duration_s: 2}]\nspeed_m_s: 0.8\n";
  ASSERT_EQ(Error(files_ + way), "");
  ASSERT_TRUE(experiment_.path.walk);
  const WalkOptions& walk = *experiment_.path.walk;
  ASSERT_EQ(walk.points.size(), 3u);
  EXPECT_LT((walk.points[0] - Eigen::Vector3d(2.5, 1, 0)).norm(), 1e-12);
  EXPECT_LT((walk.points[2] - Eigen::Vector3d(1.5, 1, 0)).norm(), 1e-12);
  EXPECT_EQ(walk.smooth_m, 0.3);
  EXPECT_EQ(walk.speed_m_s, 0.8);
  EXPECT_NEAR(walk.max_turn_rate_rad_s, M_PI / 4, 1e-12);
  ASSERT_EQ(walk.stops.size(), 1u);
  EXPECT_EQ(walk.stops[0].duration_s, 2.0);
  EXPECT_EQ(experiment_.path.height_m, 1.5);

  const std::string in_space =
      "path: {way_points: [[1, 1, 0], [4, 1, 0.5]], corner_radius_m: 0.3, body_height_m: 1}\n"
      "speed_m_s: 1\n";
  ASSERT_EQ(Error(files_ + in_space), "");
  EXPECT_EQ(experiment_.path.walk->points[1].z(), 0.5);
  EXPECT_EQ(Error(files_ + "path: {way_points: [[1, 1, 0], [4]], corner_radius_m: 0.3, "
                           "body_height_m: 1}\nspeed_m_s: 1\n"),
            ":3: a way point is [x, y] or [x, y, z]");
  EXPECT_EQ(Error(files_ + "path: {way_points: [[1, 1, 0], [4, 1, 0]], length_m: 4, "
                           "corner_radius_m: 0.3, body_height_m: 1}\nspeed_m_s: 1\n"),
            ":3: the path is only 3.000000 m long");
}

TEST_F(ExperimentText, ReadsPathFilesAndDropsTheirDoors) {
  WriteTestFile("way.path", "smooth 0.2\ndrop 17468\npoint 1.5 2.2 0\npoint 3 2.2 0\n");
  const std::string name = "ExperimentText_ReadsPathFilesAndDropsTheirDoors_way.path";
  const std::string text =
      "building: " + kConfigs + "/buildings/AC20-FZK-Haus.ply\nrig: " + kConfigs +
      "/rigs/paper.yaml\npath: {file: " + name + ", body_height_m: 1.5}\nspeed_m_s: 1\n";
  ASSERT_EQ(Error(text), "");
  ASSERT_TRUE(experiment_.path.walk);
  EXPECT_EQ(experiment_.path.walk->smooth_m, 0.2);
  const size_t num_faces = experiment_.building.faces.size();
  ASSERT_EQ(Error(text + "drop: [19199, 19504]\n"), "");
  EXPECT_LT(experiment_.building.faces.size(), num_faces);
}

TEST_F(ExperimentText, ReadsWhatMovesAndFaults) {
  ASSERT_EQ(Error(all_ + "moving:\n  people: [{walks: [[1, 1], [2, 1]]}, {follows_m: 2}]\n"
                         "  doors: [{hinge: [1, 2], shut_deg: 0, open_deg: 90, period_s: 3}]\n"
                         "faults: {outliers: 0.1, scanners: [{name: top, range_bias_m: 0.02, "
                         "range_scale: 1.01}]}\n"),
            "");
  ASSERT_EQ(experiment_.moving.people.size(), 2u);
  EXPECT_EQ(experiment_.moving.people[1].follows_m, 2.0);
  EXPECT_EQ(experiment_.moving.body_height_m, 1.5);
  ASSERT_EQ(experiment_.moving.doors.size(), 1u);
  EXPECT_NEAR(experiment_.moving.doors[0].open_rad, M_PI / 2, 1e-12);
  EXPECT_EQ(experiment_.faults.outliers, 0.1);
  ASSERT_EQ(experiment_.faults.scanners.size(), 3u);
  EXPECT_EQ(experiment_.faults.scanners[0].range_bias_m, 0.02);
  EXPECT_EQ(experiment_.faults.scanners[0].range_scale, 1.01);
  EXPECT_EQ(Error(all_ + "moving:\n  people: [{speed_m_s: 1}]\n"),
            ":9: a person has one of walks, follows_m and circles_m");
}

TEST_F(ExperimentText, ErrorsNameFileAndLine) {
  EXPECT_EQ(Error(all_ + "colour: red\n"), ":8: unknown key 'colour'");
  EXPECT_EQ(Error(all_ + "noise: {scale: -1}\n"),
            ":8: 'noise.scale' must lie between 0 and 1000, not -1");
  EXPECT_EQ(Error(all_ + "scanner_phases_s: [0, 0]\n"),
            ":8: 'scanner_phases_s' must be a list of 3 numbers");
  EXPECT_EQ(Error(files_ + path_), ":1: missing key 'speed_m_s'");
  EXPECT_EQ(Error(files_ + path_ + "  laps: 2\nspeed_m_s: 1\n"),
            ":7: laps need a closed path");
  EXPECT_EQ(Error(files_ + path_ + "  closed: true\n  laps: 2\n  length_m: 3\nspeed_m_s: 1\n"),
            ":8: give either laps or length_m, not both");
  EXPECT_EQ(Error("building: no/such.yaml\n").rfind(":1: there is no file ", 0), 0u);
}

TEST_F(ExperimentText, PathsThroughWallsAreErrors) {
  const std::string tail = "  corner_radius_m: 0.2\n  body_height_m: 1.5\nspeed_m_s: 1\n";
  const auto simulate = [&](const std::string& way_points) {
    const std::string path = WriteTestFile(
        "experiment.yaml", files_ + "path:\n  way_points:\n" + way_points + tail);
    const std::string message = ErrorOf([&] { Simulator simulator(ReadExperiment(path)); });
    EXPECT_EQ(message.rfind(path, 0), 0u) << message;
    return message.substr(std::min(path.size(), message.size()));
  };
  // Out through the first wall on the left, and into the pillar.
  EXPECT_EQ(simulate("    - [2, 1]\n    - [4, 1]\n    - [9, 1]\n")
                .rfind(":6: after this way point the path comes too close to a wall, floor or "
                       "ceiling at (5.",
                       0),
            0u);
  EXPECT_EQ(simulate("    - [1.5, 2.4]\n    - [4, 2.4]\n")
                .rfind(":5: after this way point the path comes too close to a wall, floor or "
                       "ceiling at (2.",
                       0),
            0u);
  EXPECT_EQ(simulate("    - [9, 1]\n    - [12, 1]\n")
                .rfind(":5: after this way point the path leaves the building or goes into a "
                       "wall at (9, 1)",
                       0),
            0u);
}

TEST_F(ExperimentText, WalksIntoMeshesAreErrors) {
  const auto simulate = [&](const std::string& way_points) {
    const std::string path = WriteTestFile(
        "experiment.yaml",
        "building: " + kConfigs + "/buildings/look_alike_floors.ply\nrig: " + kConfigs +
            "/rigs/paper.yaml\npath: {way_points: " + way_points +
            ", corner_radius_m: 0.3, body_height_m: 1.5}\nspeed_m_s: 1\n");
    const std::string message = ErrorOf([&] { Simulator simulator(ReadExperiment(path)); });
    return message.substr(std::min(path.size(), message.size()));
  };
  EXPECT_EQ(simulate("[[4, 4, 0], [5, 4, 0]]"), "");
  // Into the wall between the halves, beside its door, and out of the house from its roof.
  EXPECT_EQ(simulate("[[5, 6.5, 0], [8, 6.5, 0]]")
                .rfind(":3: the path comes too close to a wall, floor or ceiling at (6.8", 0),
            0u);
  EXPECT_EQ(
      simulate("[[5, 4, 6], [-9, 4, 6]]").rfind(":3: the path has no floor below at (-0.2", 0),
      0u);
}

// Up a ramp of a floor plan, whose free space is known.
TEST_F(ExperimentText, WalksOverRampsStayInTheFreeSpace) {
  const auto simulate = [&](const std::string& way_points) {
    const std::string path = WriteTestFile(
        "experiment.yaml",
        "building: " + kConfigs + "/buildings/ramp_and_arc.yaml\nrig: " + kConfigs +
            "/rigs/paper.yaml\npath: {way_points: " + way_points +
            ", corner_radius_m: 0.3, body_height_m: 1.5}\nspeed_m_s: 1\n");
    const std::string message = ErrorOf([&] { Simulator simulator(ReadExperiment(path)); });
    return message.substr(std::min(path.size(), message.size()));
  };
  EXPECT_EQ(simulate("[[5, 0, 0], [6, 0, 0], [12, 0, 0.6], [13, 0, 0.6]]"), "");
  // Beside the ramp; the wall is 1.2 m from its middle.
  EXPECT_EQ(simulate("[[5, 0, 0], [10, 2, 0.4]]")
                .rfind(":3: the path comes too close to a wall, floor or ceiling at (7.", 0),
            0u);
  // Level, 0.1 m above the floor, against the ramp.
  EXPECT_EQ(simulate("[[5, 0, -1.4], [20, 0, -1.4]]")
                .rfind(":3: the path comes too close to a wall, floor or ceiling at (", 0),
            0u);
  EXPECT_EQ(simulate("[[30, 0, 0], [31, 0, 0]]")
                .rfind(":3: the path leaves the building or goes into a wall at (30", 0),
            0u);
}

// The YAML blocks of a page that hold a word, in their order.
std::vector<std::string> BlocksOf(const std::string& page, const std::string& word) {
  std::ifstream file(SourceDir() + "/docs/" + page);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  const std::string fence = "```yaml\n";
  std::vector<std::string> blocks;
  for (size_t at = text.find(fence); at != std::string::npos; at = text.find(fence, at)) {
    at += fence.size();
    const std::string block = text.substr(at, text.find("```", at) - at);
    if (block.find(word) != std::string::npos) blocks.push_back(block);
  }
  return blocks;
}

TEST(Documentation, BuildingsLoad) {
  const std::vector<std::string> blocks = BlocksOf("inputs.md", "outlines:");
  EXPECT_EQ(blocks.size(), 2u);
  for (const std::string& block : blocks) {
    const Building building = ReadBuilding(WriteTestFile("building.yaml", block));
    EXPECT_GT(building.faces.size(), 20u);
  }
}

TEST(Documentation, TheGuidesExperimentLoads) {
  const std::vector<std::string> buildings = BlocksOf("guide.md", "outlines:");
  const std::vector<std::string> experiments = BlocksOf("guide.md", "way_points:");
  ASSERT_EQ(buildings.size(), 1u);
  ASSERT_EQ(experiments.size(), 1u);
  std::string text = experiments[0];
  const auto replace = [&text](const std::string& before, const std::string& after) {
    const size_t at = text.find(before);
    ASSERT_NE(at, std::string::npos) << before;
    text.replace(at, before.size(), after);
  };
  replace("my_building.yaml", WriteTestFile("my_building.yaml", buildings[0]));
  replace("../configs", kConfigs);
  EXPECT_EQ(ErrorOf([&] {
              Simulator simulator(ReadExperiment(WriteTestFile("my_experiment.yaml", text)));
            }),
            "");
}

}  // namespace
}  // namespace plumbline
