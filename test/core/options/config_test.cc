#include "core/options/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "test/testing/paths.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ConfigTest : public TemporaryDirectoryTest {
 protected:
  MapperOptions Read(const std::string& text) {
    WriteBytes(File(), text);
    return ReadMapperOptions(File());
  }
  std::string ReadError(const std::string& text) {
    return ErrorOf([&] { Read(text); });
  }
  std::string File() const { return (directory_ / "config.yaml").string(); }
};

// Every option with a value that is not its default; a new option that lacks here is caught by
// the count of lines.
MapperOptions UnusualOptions() {
  MapperOptions o;
  o.trajectory = {0.0875, 2.25, 1.5, 123.0, 0.45, 0.75, false, 0.25, 0.75, 33.0};
  o.segmentation.min_points = 9;
  o.segmentation.significance = 2.5e-5;
  o.segmentation.ambiguity_sigmas = 1.25;
  o.association = {3e-6, 0.3, 0.0125, 7.5};
  o.tracking = {2.5, 0.75, 4.0, 0.5, 3.5};
  o.planes = {11, 1.75, 7, 1.25, 0.75, 2.5};
  o.window = {SolverKind::kGaussNewton, 33, 0.75, false, true};
  o.points = {false, 0.5, 0.0375, 0.25, false, 12.5};
  o.rules = {false, false, false, false, false, false, false, false, false, false, false};
  o.odometry = {false, 0.03, 0.2};
  o.loop_closure = {false, 77};
  o.batch = {
      SolverKind::kGaussNewton, FactorKind::kPoint, 3, false, CorrelatedErrorsKind::kOff};
  o.max_gap_s = 0.6;
  return o;
}

TEST_F(ConfigTest, WhatIsWrittenIsRead) {
  const MapperOptions unusual = UnusualOptions();
  const std::string yaml = MapperOptionsToYaml(unusual);
  const MapperOptions read = Read(yaml);
  EXPECT_EQ(MapperOptionsToYaml(read), yaml);
  EXPECT_EQ(read.trajectory.knot_interval_s, 0.0875);
  EXPECT_EQ(read.trajectory.angular_acceleration_density_deg_s2, 123.0);
  EXPECT_EQ(read.trajectory.acceleration_correlation_s, 0.45);
  EXPECT_EQ(read.trajectory.vertical_velocity_correlation_s, 0.75);
  EXPECT_FALSE(read.trajectory.estimate_densities);
  EXPECT_EQ(read.trajectory.bridging_acceleration_density_m_s2, 0.25);
  EXPECT_EQ(read.trajectory.initial_turn_rate_stddev_deg_s, 33.0);
  EXPECT_EQ(read.segmentation.min_points, 9);
  EXPECT_EQ(read.segmentation.ambiguity_sigmas, 1.25);
  EXPECT_EQ(read.association.significance, 3e-6);
  EXPECT_EQ(read.association.surface_flatness_m, 0.0125);
  EXPECT_EQ(read.association.huber_width, 7.5);
  EXPECT_EQ(read.tracking.max_start_search_s, 2.5);
  EXPECT_EQ(read.tracking.lost_position_m, 0.75);
  EXPECT_EQ(read.tracking.lost_rotation_deg, 4.0);
  EXPECT_EQ(read.tracking.max_undecided_s, 0.5);
  EXPECT_EQ(read.planes.min_scans, 7);
  EXPECT_EQ(read.planes.small_m, 1.25);
  EXPECT_EQ(read.planes.min_age_of_small_s, 0.75);
  EXPECT_EQ(read.planes.max_tentative_age_s, 2.5);
  EXPECT_FALSE(read.points.hold_pose);
  EXPECT_EQ(read.points.cell_m, 0.5);
  EXPECT_EQ(read.points.min_age_s, 0.25);
  EXPECT_FALSE(read.points.leave_out_moving);
  EXPECT_EQ(read.window.num_scans, 33);
  EXPECT_EQ(read.window.step_s, 0.75);
  EXPECT_FALSE(read.window.resegment);
  EXPECT_TRUE(read.window.keep_estimates);
  EXPECT_FALSE(read.loop_closure.enabled);
  EXPECT_EQ(read.loop_closure.max_gap_scans, 77);
  EXPECT_EQ(read.batch.factor, FactorKind::kPoint);
  EXPECT_EQ(read.batch.max_rounds, 3);
  EXPECT_FALSE(read.batch.resegment);
  EXPECT_EQ(read.batch.correlated_errors, CorrelatedErrorsKind::kOff);
  EXPECT_EQ(read.window.solver, SolverKind::kGaussNewton);
  EXPECT_EQ(read.batch.solver, SolverKind::kGaussNewton);
  EXPECT_FALSE(read.rules.thin_evidence);
  EXPECT_FALSE(read.odometry.enabled);
  EXPECT_EQ(read.odometry.length_noise, 0.03);
  EXPECT_EQ(read.odometry.turn_noise, 0.2);
  EXPECT_EQ(read.max_gap_s, 0.6);
}

// A line of the YAML that both sets of options share was forgotten above or in the file.
TEST_F(ConfigTest, EveryOptionIsWritten) {
  std::istringstream defaults(MapperOptionsToYaml(MapperOptions()));
  std::istringstream unusual(MapperOptionsToYaml(UnusualOptions()));
  std::string a, b;
  while (std::getline(defaults, a) && std::getline(unusual, b)) {
    if (a.front() == ' ') {
      EXPECT_NE(a, b);
    }
  }
  EXPECT_FALSE(std::getline(unusual, b));
}

TEST_F(ConfigTest, APlanarRigHasDefaultsOfItsOwn) {
  const MapperOptions planar = MapperOptions::DefaultsFor(true);
  EXPECT_LT(planar.trajectory.acceleration_density_m_s2,
            MapperOptions().trajectory.acceleration_density_m_s2);
  EXPECT_EQ(MapperOptionsToYaml(MapperOptions::DefaultsFor(false)),
            MapperOptionsToYaml(MapperOptions()));
  WriteBytes(File(), "window: {num_scans: 7}\n");
  const MapperOptions read = ReadMapperOptions(File(), planar);
  EXPECT_EQ(read.window.num_scans, 7);
  EXPECT_EQ(read.trajectory.acceleration_density_m_s2,
            planar.trajectory.acceleration_density_m_s2);
}

TEST_F(ConfigTest, WhatIsNotNamedKeepsItsDefault) {
  EXPECT_EQ(MapperOptionsToYaml(Read("window: {num_scans: 10}\n")),
            MapperOptionsToYaml(MapperOptions()));
  const MapperOptions options = Read("planes:\n  min_scans: 5\n");
  EXPECT_EQ(options.planes.min_scans, 5);
  EXPECT_EQ(options.planes.min_points, MapperOptions().planes.min_points);
}

TEST_F(ConfigTest, UnknownKeysAreErrorsWithTheirLine) {
  EXPECT_THAT(ReadError("window:\n  num_scans: 10\n  num_scan: 10\n"),
              AllOf(HasSubstr(File() + ":3: "), HasSubstr("num_scan")));
  EXPECT_THAT(ReadError("window: {num_scans: 10}\nwindows: {num_scans: 10}\n"),
              AllOf(HasSubstr(File() + ":2: "), HasSubstr("windows")));
  EXPECT_THAT(ReadError("window:\n  num_scans: 10\n  num_scans: 11\n"),
              HasSubstr(File() + ":"));
}

TEST_F(ConfigTest, RenamedKeysAreErrorsThatNameTheNewOne) {
  struct Renamed {
    std::string text;
    std::string new_key;
  };
  for (const Renamed& renamed :
       {Renamed{"planes:\n  max_candidate_age_s: 1.0\n", "max_tentative_age_s"},
        Renamed{"window:\n  recut_segments: true\n", "resegment"},
        Renamed{"window:\n  keep_statements: true\n", "keep_estimates"},
        Renamed{"batch:\n  recut_segments: true\n", "resegment"}}) {
    EXPECT_THAT(ReadError(renamed.text),
                AllOf(HasSubstr(File() + ":2: "), HasSubstr("'" + renamed.new_key + "'")));
  }
}

TEST_F(ConfigTest, RemovedKeysAreErrorsThatSayWhy) {
  EXPECT_THAT(ReadError("batch:\n  estimate_motion_noise: true\n"),
              AllOf(HasSubstr(File() + ":2: "), HasSubstr("that the recording shows")));
}

TEST_F(ConfigTest, ValuesOutOfRangeAreErrorsWithTheirLine) {
  for (const char* text : {"batch:\n  factor: beam\n",
                           "batch:\n  max_rounds: 0\n",
                           "window:\n  num_scans: many\n",
                           "window:\n  num_scans: 10.5\n",
                           "association:\n  significance: 0.0\n",
                           "association:\n  significance: .nan\n",
                           "loop_closure:\n  enabled: perhaps\n",
                           "trajectory:\n  knot_interval_s: -0.1\n"}) {
    EXPECT_THAT(ReadError(text), HasSubstr(File() + ":2: ")) << text;
  }
}

TEST_F(ConfigTest, OptionsThatNoFileGaveCheckThemselves) {
  EXPECT_EQ(ErrorOf([] { MapperOptions().Check(); }), "no error");
  EXPECT_EQ(ErrorOf([] { UnusualOptions().Check(); }), "no error");
  MapperOptions options;
  options.window.num_scans = 1;
  EXPECT_THAT(ErrorOf([&] { options.Check(); }),
              AllOf(HasSubstr("window.num_scans"), HasSubstr("not 1")));
  options = {};
  options.association.significance = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(ErrorOf([&] { options.Check(); }), HasSubstr("association.significance"));
}

TEST_F(ConfigTest, MissingFileIsNamed) {
  EXPECT_THAT(ErrorOf([this] { ReadMapperOptions(File()); }), HasSubstr(File()));
}

TEST_F(ConfigTest, SectionOfAnExperimentCounts) {
  const std::string experiment = "building: b.yaml\nspeed_m_s: 1.0\nanything: [1, 2]\n";
  EXPECT_EQ(Read(experiment + "mapper:\n  window: {num_scans: 31}\n").window.num_scans, 31);
  EXPECT_EQ(MapperOptionsToYaml(Read(experiment)), MapperOptionsToYaml(MapperOptions()));
  EXPECT_THAT(ReadError(experiment + "mapper:\n  window: {scans: 31}\n"),
              AllOf(HasSubstr(File() + ":5: "), HasSubstr("scans")));
}

TEST_F(ConfigTest, EveryShippedExperimentLoads) {
  int num_files = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(ConfigsDir() + "/experiments")) {
    if (!entry.is_regular_file()) continue;
    EXPECT_EQ(ErrorOf([&] { ReadMapperOptions(entry.path().string()); }), "no error");
    ++num_files;
  }
  EXPECT_GE(num_files, 6);
  const std::string drift = ConfigsDir() + "/experiments/corridor_three_loops.yaml";
  EXPECT_FALSE(ReadMapperOptions(drift).loop_closure.enabled);
}

}  // namespace
}  // namespace plumbline
