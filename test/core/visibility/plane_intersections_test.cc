#include "core/visibility/plane_intersections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/surface/landmark_view.h"

namespace plumbline {
namespace {

// Seen from the origin, beams at whole degrees: a segment on the wall y = 2 from x = 0.93 (65
// degrees) to the left, and a wall across it at x = 1, which it meets at 63.4 degrees.
class PlaneIntersectionsTest : public ::testing::Test {
 protected:
  PlaneIntersectionsTest() {
    line_.angle_increment = M_PI / 180.0;
    line_.ranges.assign(180, 1.0f);
  }

  static Landmark Wall(int id,
                       const Eigen::Vector3d& normal,
                       const Eigen::Vector3d& a,
                       const Eigen::Vector3d& b) {
    Landmark wall = MakeVerticalLandmark(normal, a);
    wall.id = id;
    wall.extent.AddSegment(a, b);
    return wall;
  }
  // The wall of the segment, seen up to x = to.
  static Landmark Ahead(double to) {
    return Wall(0, {0.0, -1.0, 0.0}, {-3.0, 2.0, 0.0}, {to, 2.0, 0.0});
  }
  // The wall across, seen between these places.
  static Landmark Across(double from_y, double to_y) {
    return Wall(1, {-1.0, 0.0, 0.0}, {1.0, from_y, 0.0}, {1.0, to_y, 0.0});
  }
  static LandmarkView Candidate(const Landmark& landmark) { return LandmarkView(landmark); }
  std::vector<PlaneIntersection> Find(const Landmark& ahead,
                                      const Landmark& across,
                                      const Rigid3d& world_from_scanner = Rigid3d()) const {
    const LandmarkView own = Candidate(ahead);
    const ScanPlacement placement = PlacementOf(world_from_scanner);
    const Trace trace(placement, own);
    return FindIntersections({line_, placement, own, trace},
                             {0.93, 2.0, 0.0},
                             PlaneSet({own, Candidate(across)}),
                             {65, -1, -1, 92, -1});
  }

  ScanLine line_;
};

TEST_F(PlaneIntersectionsTest, WallInFrontOfTheOtherMeetsIt) {
  const Landmark across = Across(0.5, 1.9);
  const auto intersections = Find(Ahead(3.0), across);
  ASSERT_EQ(intersections.size(), 1u);
  EXPECT_EQ(intersections[0].last, 1) << "beam 64";
  EXPECT_TRUE(intersections[0].at_wall);
}

TEST_F(PlaneIntersectionsTest, WallOnTheOtherSideOfAThinOneDoesNot) {
  EXPECT_TRUE(Find(Ahead(3.0), Across(2.1, 3.0)).empty());
}

// Just above the floor, which the wall's trace leads to.
TEST_F(PlaneIntersectionsTest, NorDoesItOnASlopingTrace) {
  Landmark ahead = Ahead(3.0);
  Landmark across = Across(2.1, 3.0);
  ahead.extent.AddSegment({-3.0, 2.0, -1.21}, {3.0, 2.0, -1.21});
  across.extent.AddSegment({1.0, 2.1, -1.21}, {1.0, 3.0, -1.21});
  const Rigid3d sloping(
      Eigen::Quaterniond(Eigen::AngleAxisd(std::atan(1.2), Eigen::Vector3d::UnitY())),
      Eigen::Vector3d::Zero());
  EXPECT_TRUE(Find(ahead, across, sloping).empty());
}

TEST_F(PlaneIntersectionsTest, FaceRoundACornerDoes) {
  EXPECT_EQ(Find(Ahead(1.0), Across(2.0, 3.0)).size(), 1u) << "touches it";
  EXPECT_EQ(Find(Ahead(1.0), Across(2.1, 3.0)).size(), 1u) << "was seen from 0.1 m on";
}

// The face round the corner, seen at other times, is turned away from the scanner.
TEST_F(PlaneIntersectionsTest, AFaceTurnedAwayIsTheWallsEdgeWhereThatEnds) {
  const Landmark away = Wall(1, {1.0, 0.0, 0.0}, {1.0, 2.0, 0.0}, {1.0, 3.0, 0.0});
  const auto edge = Find(Ahead(1.0), away);
  ASSERT_EQ(edge.size(), 1u);
  EXPECT_TRUE(edge[0].is_edge);
  EXPECT_FALSE(edge[0].goes_on);
  const auto before_door = Find(Ahead(3.0), away);
  ASSERT_EQ(before_door.size(), 1u);
  EXPECT_FALSE(before_door[0].is_edge);
  EXPECT_TRUE(before_door[0].goes_on);
  const auto facing = Find(Ahead(1.0), Across(2.0, 3.0));
  ASSERT_EQ(facing.size(), 1u);
  EXPECT_FALSE(facing[0].is_edge);
}

TEST_F(PlaneIntersectionsTest, WhatWasNotSeenThereDoesNot) {
  EXPECT_TRUE(Find(Ahead(3.0), Across(-3.0, 1.0)).empty());
}

}  // namespace
}  // namespace plumbline
