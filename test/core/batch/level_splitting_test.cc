#include "core/batch/level_splitting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "core/util/time.h"
#include "test/testing/plane_scene.h"

namespace plumbline {
namespace {

constexpr double kWall = 3.0;  // m, along x

using Pairs = std::set<std::pair<int, int>>;

// A level scanner at rest in the origin sees the wall x = 3.
class LevelSplittingTest : public testing::Test {
 protected:
  LevelSplittingTest() {
    rig_.scanners.resize(1);
    rig_.scanners[0].beams = 181;
    rig_.scanners[0].field_of_view_deg = 180.0;
    state_.trajectory.ExtendTo(NanosecondsFromSeconds(1.0));
    Landmark wall = MakeVerticalLandmark({-1.0, 0.0, 0.0}, {kWall, 0.0, 0.0});
    wall.heading_fixed = true;
    wall.extent.AddSegment({kWall, -2.0, 0.0}, {kWall, 2.0, 0.0});
    state_.landmarks.push_back(wall);
  }

  // A segment on the wall between two of its y, at the instant of a scan.
  void See(double first_y, double last_y, int scan_index) {
    const ScenePlane plane = {{-1.0, 0.0, 0.0}, -kWall};
    const ScanLine line = TakeScanLine(
        {plane},
        rig_.scanners[0],
        0,
        NanosecondsFromSeconds(0.1 + 0.025 * scan_index),
        [](int64_t) { return Rigid3d(); },
        0.0,
        &random_);
    const auto beam = [](double y) {
      return 90 + static_cast<int>(std::lround(std::atan2(y, kWall) * 180.0 / M_PI));
    };
    Observation observation = ObservePlane(
        line, rig_.scanners[0], Rigid3d(), plane, beam(first_y), beam(last_y));
    observation.landmark_id = 0;
    observation.scan_index = scan_index;
    state_.observations.push_back(observation);
  }

  // The wall's cells between two of its y as a level.
  LevelOnSurface Level(double first_y, double last_y, double step_m) const {
    LevelOnSurface level{0, step_m, {}, {}};
    for (double y = first_y; y < last_y; y += 0.5 * PatchExtent::kCellSize) {
      level.cells.push_back(
          PatchExtent::CellAt(state_.landmarks[0].extent.Project({kWall, y, 0.0})));
    }
    return level;
  }

  std::vector<int> Ids() const {
    std::vector<int> ids;
    for (const Observation& o : state_.observations) ids.push_back(o.landmark_id);
    return ids;
  }

  Pairs Split(const std::vector<LevelOnSurface>& levels) {
    openings_.resize(state_.landmarks.size());
    return SplitLevels(rig_, options_, levels, &openings_, &state_);
  }

  Rig rig_;
  AssociationOptions options_;
  std::vector<PlaneOpenings> openings_;
  MapState state_{Trajectory(0, 125'000'000, Rigid3d()), {}, {}, 0};
  std::mt19937_64 random_{1};
};

TEST_F(LevelSplittingTest, SegmentsMostlyOnALevelGoToALandmarkOfItsOwn) {
  See(-1.5, 0.4, 0);
  See(0.7, 1.4, 1);   // on the level
  See(-0.8, 1.4, 2);  // across, less than half of it on the level
  See(0.3, 1.6, 3);   // across, more than half of it
  EXPECT_EQ(Split({Level(0.5, 1.75, 0.03)}), (Pairs{{0, 1}}));
  EXPECT_EQ(Ids(), (std::vector<int>{0, 1, 0, 1}));
  const Landmark& on_level = state_.landmarks[1];
  EXPECT_EQ(on_level.id, 1);
  EXPECT_FALSE(on_level.heading_fixed);
  EXPECT_EQ(on_level.num_segments, 2);
  EXPECT_LT(on_level.Width(), 1.5);
  EXPECT_EQ(state_.landmarks[0].num_segments, 2);
  EXPECT_EQ(openings_.size(), 2u);
}

TEST_F(LevelSplittingTest, SubMinimumSegmentsGoWithTheSegmentsOfTheirLevel) {
  See(-1.0, -0.8, 0);
  See(0.7, 0.9, 1);
  See(-1.7, -1.6, 2);
  state_.sub_minimum_segments = std::move(state_.observations);
  state_.observations.clear();
  See(-1.5, 0.4, 3);
  See(0.7, 1.4, 4);
  Split({Level(0.5, 1.75, 0.03), Level(-1.99, -1.5, 0.03)});
  EXPECT_EQ(Ids(), (std::vector<int>{0, 1}));
  std::vector<int> ids;
  for (const Observation& segment : state_.sub_minimum_segments) {
    ids.push_back(segment.landmark_id);
  }
  EXPECT_EQ(ids, (std::vector<int>{0, 1, 0}));  // no segment founds the second level
}

TEST_F(LevelSplittingTest, LevelsThatNoSegmentLiesOnGetNoLandmark) {
  See(-0.8, 1.4, 0);
  EXPECT_TRUE(Split({Level(0.5, 1.75, 0.03)}).empty());
  EXPECT_EQ(state_.landmarks.size(), 1u);
}

TEST_F(LevelSplittingTest, AStepWithinTheUnevennessOfOneSurfaceStays) {
  See(0.7, 1.4, 0);
  const double step_m = 2.9 * options_.surface_flatness_m;
  EXPECT_TRUE(Split({Level(0.5, 1.75, -step_m)}).empty());
  EXPECT_EQ(Ids(), std::vector<int>{0});
}

TEST_F(LevelSplittingTest, TwoLevelsGetTwoLandmarks) {
  See(-1.4, -0.7, 0);
  See(0.7, 1.4, 1);
  EXPECT_EQ(Split({Level(0.5, 1.75, 0.03), Level(-1.75, -0.5, 0.03)}),
            (Pairs{{0, 1}, {0, 2}}));
  EXPECT_EQ(Ids(), (std::vector<int>{1, 2}));
  EXPECT_FALSE(state_.landmarks[0].heading_fixed) << "nothing is left on it";
  EXPECT_NE(state_.landmarks[1].heading_fixed, state_.landmarks[2].heading_fixed);
}

}  // namespace
}  // namespace plumbline
