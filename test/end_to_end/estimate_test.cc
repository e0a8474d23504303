#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

#include "core/batch/batch.h"
#include "core/mapping/mapper.h"
#include "core/result/result_reader.h"
#include "core/result/result_writer.h"
#include "core/util/error.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

using MappingEstimateTest = MappingTest;

Scenario Base() {
  Scenario scenario;
  scenario.building = PillarRoom();
  scenario.scanners = TiltedRig();
  scenario.path = PillarWalk(3.0, 1.0);
  return scenario;
}

TEST(Batch, ExpectsAssociationsToSettleAtTheRateTheyDo) {
  EXPECT_EQ(ChangesToCome(100, 0), 100.0) << "no round before";
  EXPECT_EQ(ChangesToCome(100, 1000), 10.0);
  EXPECT_EQ(ChangesToCome(100, 50), 100.0) << "they become more";
  EXPECT_EQ(ChangesToCome(0, 0), 0.0);
}

const char* const kFiles[] = {
    "trajectory.tum", "planes.json", "planes.ply", "map.ply", "map.pcd"};

TEST_F(MappingEstimateTest, ThreadsDoNotChangeAByte) {
  WriteRecording(Simulate(Base()));
  Map("", 1);
  std::filesystem::rename(Path("result"), Path("one_thread"));
  Map("", 2);
  std::filesystem::rename(Path("result"), Path("two_threads"));
  Map("", 2);
  for (const char* file : kFiles) {
    const std::string bytes = ReadBytes(directory_ / "one_thread" / file);
    EXPECT_FALSE(bytes.empty()) << file;
    EXPECT_TRUE(bytes == ReadBytes(directory_ / "two_threads" / file)) << file;
    EXPECT_TRUE(bytes == ReadBytes(directory_ / "result" / file)) << file;
  }
}

// Two ways to estimate, by their configuration, give one map of a recording: planes to a
// twentieth of their standard deviations, poses to a tenth of the planes' smallest.
class OneMapTest : public MappingTest,
                   public testing::WithParamInterface<std::pair<const char*, const char*>> {};

TEST_P(OneMapTest, EitherWay) {
  WriteRecording(Simulate(Base()));
  Map(GetParam().first);
  const std::vector<StampedPose> poses = ReadTrajectory(Path("result/trajectory.tum"));
  const std::vector<PlanePatch> planes = ReadPlanes(Path("result/planes.json"));
  const double variance_factor = summary_.variance_factor;
  Map(GetParam().second);
  const std::vector<StampedPose> other_poses = ReadTrajectory(Path("result/trajectory.tum"));
  const std::vector<PlanePatch> other_planes = ReadPlanes(Path("result/planes.json"));
  EXPECT_NEAR(summary_.variance_factor, variance_factor, 1e-3);
  ASSERT_EQ(other_planes.size(), planes.size());
  double smallest_sigma_m = 1.0;
  for (size_t i = 0; i < planes.size(); ++i) {
    const double sigma_m = planes[i].sigma_distance_m;
    ASSERT_GT(sigma_m, 0.0);
    smallest_sigma_m = std::min(smallest_sigma_m, sigma_m);
    EXPECT_NEAR(other_planes[i].SignedDistance(planes[i].centre),
                0.0,
                0.05 * planes[i].sigma_distance_m);
    EXPECT_NEAR(other_planes[i].sigma_distance_m, sigma_m, 0.02 * sigma_m);
    EXPECT_LE(std::asin(other_planes[i].normal.cross(planes[i].normal).norm()),
              0.05 * planes[i].sigma_angle_rad + 1e-12);
  }
  ASSERT_EQ(other_poses.size(), poses.size());
  for (size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT(
        (other_poses[i].world_from_body.translation - poses[i].world_from_body.translation)
            .norm(),
        0.1 * smallest_sigma_m);
  }
}

// A segment's matrix keeps all that its beams say: a hundredth of a standard deviation is what
// it may leave out in each of a few thousand segments (CompressSegment), and where the two
// estimations stop.
INSTANTIATE_TEST_SUITE_P(FactorsOfSegmentsAndOfBeams,
                         OneMapTest,
                         testing::Values(std::make_pair("batch: {factor: segment}\n",
                                                        "batch: {factor: point}\n")));

// The default, ceres::Solve, against our own Gauss-Newton on the same groups.
INSTANTIATE_TEST_SUITE_P(
    SolversOfBatchAndWindow,
    OneMapTest,
    testing::Values(
        std::make_pair("", "batch: {solver: gauss_newton}\n"),
        std::make_pair("",
                       "window: {solver: gauss_newton}\nbatch: {solver: gauss_newton}\n")));

TEST_F(MappingEstimateTest, WindowsEstimatesAreKeptWhereAskedFor) {
  Scenario scenario = Base();
  Run(scenario);
  EXPECT_FALSE(std::filesystem::exists(Path("result/window_trajectory.tum")));
  scenario.config = "window: {keep_estimates: true}\n";
  Run(scenario);
  const auto batch = ReadTrajectory(Path("result/trajectory.tum"));
  const auto window = ReadTrajectory(Path("result/window_trajectory.tum"));
  ASSERT_GT(window.size(), 10u);
  EXPECT_LT(window.size(), batch.size()) << "one for each solution";
  const StampedPose& last = window.back();
  const StampedPose& final_pose = batch.back();
  EXPECT_LT((last.world_from_body.translation - final_pose.world_from_body.translation).norm(),
            0.3)
      << "the same place, but for the motion within a knot interval";
  std::ifstream file(Path("result/window_trajectory_covariance.csv"));
  size_t num_lines = 0;
  for (std::string line; std::getline(file, line);) ++num_lines;
  EXPECT_EQ(num_lines, window.size() + 1);
  const auto planes = ReadPlanes(Path("result/window_planes.json"));
  EXPECT_GE(planes.size(), 3u);
}

// Without noise, what is wrong with the window's planes is mostly beams of their neighbours:
// more than half of the squared errors go where segments give these back.
TEST_F(MappingEstimateTest, WindowsPlanesKeepToTheirOwnBeams) {
  Scenario scenario = Base();
  scenario.more = "noise: {scale: 0}\n";
  const SimulatedRecording recording = Simulate(scenario);
  WriteRecording(recording);
  const auto sum_of_squares = [&](const std::string& resegmented) {
    Map("window: {keep_estimates: true, resegment: " + resegmented + "}\n");
    std::filesystem::rename(Path("result/window_planes.json"), Path("result/planes.json"));
    double sum = 0.0;
    for (const PlaneMatch& match : EvaluateResult(recording).planes.list) {
      sum += std::pow(match.distance_m / match.sigma_distance_m, 2);
    }
    return sum;
  };
  EXPECT_LT(sum_of_squares("true"), 0.5 * sum_of_squares("false"));
}

TEST(VarianceFactorTest, SmallIsSilentLargeWarnsAstrayIsAnError) {
  EXPECT_FALSE(JudgeVarianceFactor(1.0));
  EXPECT_FALSE(JudgeVarianceFactor(2.9));
  const std::optional<std::string> warning = JudgeVarianceFactor(4.0);
  ASSERT_TRUE(warning);
  EXPECT_NE(warning->find("2.0 times as far"), std::string::npos) << *warning;
  try {
    JudgeVarianceFactor(178.0);
    FAIL() << "not judged astray";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("13.3 times as far"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace plumbline
