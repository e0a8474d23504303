#include "core/batch/loop_closures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/util/time.h"
#include "test/testing/plane_scene.h"

namespace plumbline {
namespace {

constexpr double kRangeNoise = 0.01;  // m
constexpr double kWall = 3.0;         // m, along x

// A level scanner at rest in the origin sees the wall x = 3 in two visits, far apart in time.
class LoopClosuresTest : public testing::Test {
 protected:
  LoopClosuresTest() {
    rig_.scanners.resize(1);
    rig_.scanners[0].range_noise_m = kRangeNoise;
    rig_.scanners[0].beams = 181;
    rig_.scanners[0].field_of_view_deg = 180.0;
    state_.trajectory.ExtendTo(NanosecondsFromSeconds(60.0));
  }

  int AddWall() {
    Landmark landmark = MakeVerticalLandmark({-1.0, 0.0, 0.0}, {kWall, 0.0, 0.0});
    landmark.id = static_cast<int>(state_.landmarks.size());
    landmark.extent.AddSegment({kWall, -1.0, 0.0}, {kWall, 1.0, 0.0});
    state_.landmarks.push_back(landmark);
    return landmark.id;
  }

  // Scans of a wall that stands at x, on the landmark.
  void See(int id, double x, int first_scan, int num_scans, double noise_m = kRangeNoise) {
    const ScenePlane wall = {{-1.0, 0.0, 0.0}, -x};
    for (int scan = first_scan; scan < first_scan + num_scans; ++scan) {
      const ScanLine line = TakeScanLine(
          {wall},
          rig_.scanners[0],
          0,
          NanosecondsFromSeconds(0.1 + 0.025 * scan),
          [](int64_t) { return Rigid3d(); },
          noise_m,
          &random_);
      Observation observation = ObservePlane(line, rig_.scanners[0], Rigid3d(), wall, 70, 110);
      observation.landmark_id = id;
      observation.scan_index = scan;
      state_.observations.push_back(observation);
    }
  }

  int NumOf(int id) const {
    return static_cast<int>(std::count_if(
        state_.observations.begin(), state_.observations.end(), [&](const Observation& o) {
          return o.landmark_id == id;
        }));
  }

  Rig rig_;
  MapperOptions options_;
  MapState state_{Trajectory(0, 125'000'000, Rigid3d()), {}, {}, 0};
  std::mt19937_64 random_{1};
};

TEST_F(LoopClosuresTest, ASurfaceInSightClosesNoLoop) {
  See(AddWall(), kWall, 0, 20);
  EXPECT_TRUE(TestLoopClosures(rig_, options_, state_).empty());
}

TEST_F(LoopClosuresTest, ARightOneIsAcceptedAndStays) {
  const int id = AddWall();
  See(id, kWall, 0, 20);
  See(id, kWall + 0.002, 1000, 20);
  const std::vector<LoopClosure> closures = TestLoopClosures(rig_, options_, state_);
  ASSERT_EQ(closures.size(), 1u);
  EXPECT_TRUE(closures[0].accepted);
  EXPECT_EQ(closures[0].surface_a, id);
  EXPECT_EQ(closures[0].surface_b, id);
  EXPECT_LT(closures[0].statistic, closures[0].threshold);
  EXPECT_NEAR(1e-9 * static_cast<double>(closures[0].time_ns), 25.1, 0.1);
  std::vector<LoopClosure> rejected;
  EXPECT_EQ(TakeBackContradictedClosures(rig_, options_, &state_, &rejected), 0);
  EXPECT_TRUE(rejected.empty());
}

// Two walls, 6 cm apart, that were taken for one.
TEST_F(LoopClosuresTest, AWrongOneIsTakenBack) {
  const int id = AddWall();
  See(id, kWall, 0, 20);
  See(id, kWall + 0.06, 1000, 20);
  std::vector<LoopClosure> rejected;
  EXPECT_EQ(TakeBackContradictedClosures(rig_, options_, &state_, &rejected), 20);
  ASSERT_EQ(rejected.size(), 1u);
  EXPECT_FALSE(rejected[0].accepted);
  EXPECT_EQ(rejected[0].surface_a, id);
  EXPECT_EQ(rejected[0].surface_b, 1);
  EXPECT_NEAR(std::abs(rejected[0].difference_m), 0.06, 0.005);
  EXPECT_GT(rejected[0].statistic, rejected[0].threshold);
  EXPECT_EQ(NumOf(0), 20);
  EXPECT_EQ(NumOf(1), 20);
}

// The same difference between two scans hangs on too little.
TEST_F(LoopClosuresTest, AGlimpseContradictsNothing) {
  const int id = AddWall();
  See(id, kWall, 0, 20);
  See(id, kWall + 0.06, 1000, 2);
  std::vector<LoopClosure> rejected;
  EXPECT_EQ(TakeBackContradictedClosures(rig_, options_, &state_, &rejected), 0);
}

TEST_F(LoopClosuresTest, SurfacesThatComeBackTogetherAreOneReturn) {
  const int a = AddWall();
  const int b = AddWall();
  See(a, kWall, 0, 20);
  See(b, kWall, 20, 20);
  See(a, kWall + 0.06, 1000, 20);
  See(b, kWall, 1020, 20);
  const std::vector<LoopClosure> closures = TestLoopClosures(rig_, options_, state_);
  ASSERT_EQ(closures.size(), 2u);
  EXPECT_EQ(closures[0].return_statistic, closures[1].return_statistic);
  EXPECT_NEAR(closures[0].return_statistic,
              closures[0].statistic + closures[1].statistic,
              1e-9 * closures[0].return_statistic);
  EXPECT_FALSE(closures[0].accepted);
  EXPECT_TRUE(closures[1].accepted);
}

}  // namespace
}  // namespace plumbline
