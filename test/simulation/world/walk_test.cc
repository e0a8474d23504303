#include "simulation/world/walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulation/world/path.h"
#include "simulation/world/path_file.h"
#include "test/testing/test_files.h"

namespace plumbline {
namespace {

constexpr double kTurnRate = M_PI / 3;

// Out, round a corner, up a ramp, and back the way it came.
WalkOptions ThereAndBack() {
  WalkOptions options;
  options.location = "walk.yaml:1";
  options.points = {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {4, 6, 1.5}, {4, 3, 0}};
  options.smooth_m = 0.4;
  options.speed_m_s = 0.9;
  options.max_turn_rate_rad_s = kTurnRate;
  return options;
}

TEST(Walk, BeginsAndEndsAtItsPoints) {
  const Walk walk(ThereAndBack());
  const double ramp = std::hypot(3.0, 1.5);
  EXPECT_NEAR(walk.length_m(), 7.0 + 2 * ramp, 1e-9);
  const WalkState begin = walk.At(0.0);
  const WalkState end = walk.At(walk.duration_s());
  // Within what smoothing leaves of the first and the last tenth of a second.
  EXPECT_LT((begin.place - Eigen::Vector3d(0, 0, 0)).norm(), 0.01);
  EXPECT_LT((end.place - Eigen::Vector3d(4, 3, 0)).norm(), 0.01);
  EXPECT_NEAR(begin.heading_rad, 0.0, 1e-6);
  EXPECT_NEAR(std::remainder(end.heading_rad - 3 * M_PI / 2, 2 * M_PI), 0.0, 1e-6);
  EXPECT_NEAR(end.travelled_m, walk.length_m(), 0.01);
}

TEST(Walk, NeverFasterThanAllowed) {
  const Walk walk(ThereAndBack());
  constexpr double kStep = 0.002;
  double fastest = 0.0;
  double fastest_turn = 0.0;
  double highest = 0.0;
  double longest_stand_s = 0.0;
  double stand_s = 0.0;
  for (double time = 0.0; time + kStep < walk.duration_s(); time += kStep) {
    const WalkState a = walk.At(time);
    const WalkState b = walk.At(time + kStep);
    const double speed = (b.place - a.place).norm() / kStep;
    fastest = std::max(fastest, speed);
    fastest_turn = std::max(fastest_turn, std::abs(b.heading_rad - a.heading_rad) / kStep);
    highest = std::max(highest, a.place.z());
    stand_s = speed < 0.02 ? stand_s + kStep : 0.0;
    longest_stand_s = std::max(longest_stand_s, stand_s);
    EXPECT_GE(b.travelled_m, a.travelled_m - 1e-12);
  }
  EXPECT_NEAR(fastest, 0.9, 0.02);
  EXPECT_LE(fastest_turn, 1.02 * kTurnRate);
  EXPECT_GT(fastest_turn, 0.9 * kTurnRate);
  EXPECT_NEAR(highest, 1.5, 0.01);
  // Half a turn on the spot at 60 deg/s takes 3 s.
  EXPECT_GT(longest_stand_s, 2.5);
  EXPECT_LT(longest_stand_s, 4.0);
}

TEST(Walk, VelocityAndTurnRateAreContinuous) {
  const Walk walk(ThereAndBack());
  constexpr double kStep = 0.001;
  const auto rates = [&](double time) {
    const WalkState a = walk.At(time);
    const WalkState b = walk.At(time + kStep);
    Eigen::Vector4d rate;
    rate << (b.place - a.place) / kStep, (b.heading_rad - a.heading_rad) / kStep;
    return rate;
  };
  for (double time = 0.0; time + 3 * kStep < walk.duration_s(); time += 0.0037) {
    // 5 m/s^2 and 300 deg/s^2 at most.
    const Eigen::Vector4d change = rates(time + kStep) - rates(time);
    ASSERT_LT(change.head<3>().norm(), 5.0 * kStep) << time;
    ASSERT_LT(std::abs(change(3)), 5.3 * kStep) << time;
  }
}

TEST(Walk, StandsAtStops) {
  WalkOptions options = ThereAndBack();
  const double without = Walk(options).duration_s();
  options.stops = {{2.0, 3.0}};
  const Walk walk(options);
  EXPECT_GT(walk.duration_s(), without + 3.0);
  EXPECT_LT(walk.duration_s(), without + 5.0);
  double stand_s = 0.0;
  for (double time = 0.0; time < walk.duration_s(); time += 0.01) {
    stand_s += std::abs(walk.At(time).travelled_m - 2.0) < 0.005 ? 0.01 : 0.0;
  }
  EXPECT_GT(stand_s, 2.8);
}

TEST(Walk, PathAddsBodyHeightAndOscillations) {
  PathOptions options;
  options.walk = ThereAndBack();
  options.height_m = 1.5;
  options.roll = {0.05, 0.9, 0.0};
  options.height = {0.02, 1.8, 0.0};
  const Path path(options);
  EXPECT_TRUE(path.is_walk());
  const Walk walk(ThereAndBack());
  EXPECT_NEAR(static_cast<double>(path.end_ns()) * 1e-9, walk.duration_s(), 1e-8);
  const Rigid3d pose = path.PoseAt(4000000000);
  const WalkState state = walk.At(4.0);
  EXPECT_NEAR(pose.translation.z(),
              state.place.z() + 1.5 + 0.02 * std::sin(2 * M_PI * 1.8 * 4.0),
              1e-12);
  const Eigen::Quaterniond expected =
      RotationFromRollPitchYaw(0.05 * std::sin(2 * M_PI * 0.9 * 4.0), 0.0, state.heading_rad);
  EXPECT_LT(pose.rotation.angularDistance(expected), 1e-9);
}

TEST(Walk, OnePointIsNoWalk) {
  WalkOptions options = ThereAndBack();
  options.points = {{1, 1, 0}, {1, 1, 0}};
  EXPECT_EQ(ErrorOf([&] { Walk walk(options); }),
            "walk.yaml:1: a path needs at least two way points");
}

TEST(PathFile, ReadsPointsSmoothingAndDoors) {
  const PathFile file = ReadPathFile(WriteTestFile(
      "a.path",
      "# a path\nbuilding house\nsmooth 0.3\ndrop 12 7\npoint 1 2 3\npoint 4 5 6\n"));
  EXPECT_EQ(file.smooth_m, 0.3);
  EXPECT_EQ(file.dropped, (std::set<int>{7, 12}));
  ASSERT_EQ(file.points.size(), 2u);
  EXPECT_EQ(file.points[1], Eigen::Vector3d(4, 5, 6));
}

TEST(PathFile, ErrorsNameFileAndLine) {
  const auto error = [](const std::string& text) {
    const std::string path = WriteTestFile("bad.path", text);
    return ErrorOf([&] { ReadPathFile(path); }).substr(path.size());
  };
  EXPECT_EQ(error("point 1 2\n"), ":1: a number is missing");
  EXPECT_EQ(error("smooth 1\npiont 1 2 3\n"), ":2: unknown word 'piont'");
  EXPECT_EQ(error("drop 3 x\n"), ":1: a number is missing");
  EXPECT_EQ(error("point 1 2 3\n"), ": a path needs at least two points");
}

}  // namespace
}  // namespace plumbline
