#include "core/judging/doubled_surfaces.h"

#include <gtest/gtest.h>

#include "test/core/judging/hand_made_map.h"

namespace plumbline {
namespace {

// Walls whose sightings are made by hand: of three rows of cells.
class DoubledSurfacesTest : public testing::Test {
 protected:
  int AddHighWall(double x) {
    const int id = map_.AddWall(x, -2.0, 2.0);
    PatchExtent& extent = map_.state().landmarks[static_cast<size_t>(id)].extent;
    for (const double z : {0.25, 0.5}) extent.AddSegment({x, -2.0, z}, {x, 2.0, z});
    return id;
  }
  void See(int id, int first_second, int last_second) {
    map_.state().landmarks[static_cast<size_t>(id)].extent.cells().Any(
        [&](const CellGrid::Cell& cell, int) {
          for (int second = first_second; second < last_second; ++second) {
            sightings_.push_back({id, cell, second, 5, 0});
          }
          return false;
        });
  }
  DoubledSurfaces Find() { return FindDoubledSurfaces(map_.state(), Sightings(sightings_)); }

  HandMadeMap map_;
  std::vector<Sighting> sightings_;
};

TEST_F(DoubledSurfacesTest, FindsAWallThatStandsTwice) {
  const int before = AddHighWall(5.0);
  const int after = AddHighWall(5.2);
  See(before, 0, 10);
  See(after, 10, 20);
  const DoubledSurfaces doubled = Find();
  ASSERT_EQ(doubled.pairs.size(), 1u);
  EXPECT_NEAR(doubled.pairs[0].separation_m, 0.2, 1e-9);
  EXPECT_GT(doubled.pairs[0].area_m2, 2.0);
  EXPECT_GT(Smoothed(doubled.shares, 5).value(), 0.4);
  EXPECT_GT(Smoothed(doubled.shares, 15).value(), 0.4);
}

TEST_F(DoubledSurfacesTest, SurfacesSeenTogetherAreTwo) {
  const int front = AddHighWall(5.0);
  const int back = AddHighWall(5.2);
  See(front, 0, 20);
  See(back, 5, 15);
  EXPECT_TRUE(Find().pairs.empty());
}

TEST_F(DoubledSurfacesTest, TheFacesOfAThinWallAreTwo) {
  const int front = AddHighWall(5.0);
  const int back = AddHighWall(5.1);
  Landmark& landmark = map_.state().landmarks[static_cast<size_t>(back)];
  const PatchExtent extent = landmark.extent;
  landmark = MakeVerticalLandmark({1.0, 0.0, 0.0}, {5.1, 0.0, 0.0});
  landmark.id = back;
  landmark.extent = extent;
  landmark.num_segments = 1;
  See(front, 0, 10);
  See(back, 10, 20);
  EXPECT_TRUE(Find().pairs.empty());
}

}  // namespace
}  // namespace plumbline
