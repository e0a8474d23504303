#include "core/batch/visited_walls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/util/time.h"
#include "test/testing/plane_scene.h"

namespace plumbline {
namespace {

// A level scanner at rest in the origin sees walls x = about 3.
class VisitedWallsTest : public testing::Test {
 protected:
  VisitedWallsTest() {
    rig_.scanners.resize(1);
    rig_.scanners[0].beams = 181;
    rig_.scanners[0].field_of_view_deg = 180.0;
    state_.trajectory.ExtendTo(NanosecondsFromSeconds(100.0));
  }

  int AddWall() {
    Landmark wall = MakeVerticalLandmark({-1.0, 0.0, 0.0}, {3.0, 0.0, 0.0});
    wall.id = static_cast<int>(state_.landmarks.size());
    wall.extent.AddSegment({3.0, -1.0, 0.0}, {3.0, 1.0, 0.0});
    state_.landmarks.push_back(wall);
    return wall.id;
  }

  // Ten scans of a wall that stands at x, taken for the landmark.
  void See(int id, double x, double from_s) {
    const ScenePlane wall = {{-1.0, 0.0, 0.0}, -x};
    for (int scan = 0; scan < 10; ++scan) {
      const ScanLine line = TakeScanLine(
          {wall},
          rig_.scanners[0],
          0,
          NanosecondsFromSeconds(from_s + 0.1 * scan),
          [](int64_t) { return Rigid3d(); },
          0.005,
          &random_);
      Observation observation = ObservePlane(line, rig_.scanners[0], Rigid3d(), wall, 70, 110);
      observation.landmark_id = id;
      observation.scan_index = static_cast<int>(10.0 * from_s) + scan;
      state_.observations.push_back(observation);
    }
    RebuildLandmarks(rig_, &state_);
  }

  void Place() {
    PlaceWalls(rig_, &state_);
    RebuildLandmarks(rig_, &state_);
  }

  double PlaceOf(int id) const {
    return -state_.landmarks[static_cast<size_t>(id)].Distance();
  }
  int NumOf(int id) const { return state_.landmarks[static_cast<size_t>(id)].num_segments; }

  Rig rig_;
  MapState state_{Trajectory(0, 125'000'000, Rigid3d()), {}, {}, 0};
  std::mt19937_64 random_{1};
};

TEST_F(VisitedWallsTest, EachVisitGetsAWallOfItsOwn) {
  const int id = AddWall();
  See(id, 3.0, 1.0);
  See(id, 3.1, 5.0);  // still in view
  See(id, 3.5, 60.0);
  EXPECT_EQ(SplitWallsByVisits(&state_), 1);
  Place();
  EXPECT_NEAR(PlaceOf(0), 3.05, 0.01);
  EXPECT_NEAR(PlaceOf(1), 3.5, 0.01);
  EXPECT_EQ(NumOf(0), 20);
  EXPECT_EQ(NumOf(1), 10);
}

TEST_F(VisitedWallsTest, TheGaugeKeepsItsWall) {
  const int id = AddWall();
  state_.landmarks[0].heading_fixed = true;
  See(id, 3.0, 1.0);
  See(id, 3.0, 60.0);
  SplitWallsByVisits(&state_);
  EXPECT_TRUE(state_.landmarks[0].heading_fixed);
  EXPECT_FALSE(state_.landmarks[1].heading_fixed);
}

TEST_F(VisitedWallsTest, WallsOfTwoVisitsThatLieTogetherAreOne) {
  const int first = AddWall();
  See(first, 3.0, 1.0);
  const int second = AddWall();
  See(second, 3.1, 60.0);
  Place();
  EXPECT_EQ(MergeVisitedWalls(&state_), 1);
  Place();
  EXPECT_EQ(NumOf(first), 20);
  EXPECT_EQ(NumOf(second), 0);
  EXPECT_NEAR(PlaceOf(first), 3.05, 0.01);
}

TEST_F(VisitedWallsTest, ADoorBesideItsWallIsNot) {
  const int wall = AddWall();
  See(wall, 3.0, 1.0);
  const int door = AddWall();
  See(door, 3.1, 2.0);
  Place();
  EXPECT_EQ(MergeVisitedWalls(&state_), 0);
}

TEST_F(VisitedWallsTest, TheNearerOneOfTwoIsTaken) {
  const int wall = AddWall();
  See(wall, 3.0, 1.0);
  const int door = AddWall();
  See(door, 3.12, 2.0);
  const int later = AddWall();
  See(later, 3.1, 60.0);
  Place();
  EXPECT_EQ(MergeVisitedWalls(&state_), 1);
  EXPECT_EQ(state_.observations.back().landmark_id, door);
}

TEST_F(VisitedWallsTest, WallsFartherApartStayTwo) {
  See(AddWall(), 3.0, 1.0);
  See(AddWall(), 3.2, 60.0);
  Place();
  EXPECT_EQ(MergeVisitedWalls(&state_), 0);
}

}  // namespace
}  // namespace plumbline
