#include "core/outputs/room_measures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/outputs/room_outlines.h"

namespace plumbline {
namespace {

using ::testing::SizeIs;

PlanePatch Upright(int id, double nx, double ny, double distance) {
  PlanePatch plane;
  plane.id = id;
  plane.normal = Eigen::Vector3d(nx, ny, 0.0).normalized();
  plane.distance = distance;
  return plane;
}

// A square room of 2 m with the origin in its middle, its south wall 0, east 1, north 2,
// west 3.
Room SquareRoom() {
  Room room;
  room.loops = {{{{-1.0, -1.0}, 0, 2.0},
                 {{1.0, -1.0}, 1, 2.0},
                 {{1.0, 1.0}, 2, 2.0},
                 {{-1.0, 1.0}, 3, 2.0}}};
  return room;
}

std::vector<PlanePatch> SquareWalls() {
  return {Upright(0, 0.0, 1.0, -1.0),
          Upright(1, -1.0, 0.0, -1.0),
          Upright(2, 0.0, -1.0, -1.0),
          Upright(3, 1.0, 0.0, -1.0)};
}

TEST(RoomMeasures, WhatAllWallsShareMovesNoArea) {
  // The origin of the model frame is uncertain by 1 cm along x and y: d moves by n.dx.
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(8, 2);
  const std::vector<PlanePatch> walls = SquareWalls();
  for (int i = 0; i < 4; ++i) {
    moves.row(2 * i + 1) = walls[static_cast<size_t>(i)].normal.head<2>().transpose() * 0.01;
  }
  Room room = SquareRoom();
  MeasureRoom(PlaneCovariance(walls, moves * moves.transpose()), StoreyLevel(), &room);
  EXPECT_NEAR(room.area_m2, 4.0, 1e-12);
  EXPECT_NEAR(room.area_stddev_m2, 0.0, 1e-9);
  ASSERT_THAT(room.dimensions, SizeIs(2));
  EXPECT_NEAR(room.dimensions[0].stddev_m, 0.0, 1e-9);
}

TEST(RoomMeasures, ATurnAboutItsMiddleMovesNoAreaButOneAboutItsEndDoes) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(8, 8);
  covariance(0, 0) = 0.01 * 0.01;  // the angle of the south wall, about the origin's foot
  Room room = SquareRoom();
  MeasureRoom(PlaneCovariance(SquareWalls(), covariance), StoreyLevel(), &room);
  EXPECT_NEAR(room.area_stddev_m2, 0.0, 1e-9);
  // The same room 3 m farther east: the wall turns about a point 3 m aside of its middle.
  std::vector<PlanePatch> walls = SquareWalls();
  walls[1].distance -= 3.0;
  walls[3].distance += 3.0;
  for (RoomEdge& edge : room.loops[0]) edge.from.x() += 3.0;
  MeasureRoom(PlaneCovariance(walls, covariance), StoreyLevel(), &room);
  EXPECT_NEAR(room.area_stddev_m2, 3.0 * 0.01 * 2.0, 1e-9);
}

TEST(RoomMeasures, DimensionsGoRoundWhatStandsBetween) {
  // A wall of 0.1 m reaches from the east wall to x = -0.2: the length from south to north is
  // measured west of it.
  Room room = SquareRoom();
  room.loops[0] = {{{-1.0, -1.0}, 0, 2.0},
                   {{1.0, -1.0}, 1, 1.3},
                   {{1.0, 0.3}, 4, 1.2},
                   {{-0.2, 0.3}, 5, 0.1},
                   {{-0.2, 0.4}, 6, 1.2},
                   {{1.0, 0.4}, 1, 0.6},
                   {{1.0, 1.0}, 2, 2.0},
                   {{-1.0, 1.0}, 3, 2.0}};
  std::vector<PlanePatch> walls = SquareWalls();
  walls.push_back(Upright(4, 0.0, -1.0, -0.3));
  walls.push_back(Upright(5, -1.0, 0.0, 0.2));
  walls.push_back(Upright(6, 0.0, 1.0, 0.4));
  MeasureRoom(PlaneCovariance(walls, Eigen::MatrixXd::Identity(14, 14)), StoreyLevel(), &room);
  const auto across = std::find_if(
      room.dimensions.begin(), room.dimensions.end(), [](const Dimension& dimension) {
        return dimension.plane_a == 0 && dimension.plane_b == 2;
      });
  ASSERT_NE(across, room.dimensions.end());
  EXPECT_NEAR(across->length_m, 2.0, 1e-9);
  EXPECT_LT(across->from.x(), -0.2);
}

TEST(RoomMeasures, ArcsCountAsArcs) {
  // A round room of radius 2 m as 60 chords.
  PlanePatch wall;
  wall.id = 5;
  wall.type = PlaneType::kCylinder;
  wall.normal = -Eigen::Vector3d::UnitX();
  wall.centre = {2.0, 0.0, 1.0};
  wall.distance = -2.0;
  wall.curvature = -0.5;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(3, 3);
  covariance(1, 1) = 0.001 * 0.001;  // its radius
  Room room;
  RoomLoop& loop = room.loops.emplace_back();
  for (int i = 0; i < 60; ++i) {
    const double turn = 2.0 * M_PI * i / 60.0;
    const double chord_m = 4.0 * std::sin(M_PI / 60.0);
    loop.push_back({{2.0 * std::cos(turn), 2.0 * std::sin(turn)}, 5, chord_m});
  }
  MeasureRoom(PlaneCovariance({wall}, covariance), StoreyLevel(), &room);
  EXPECT_NEAR(room.area_m2, 4.0 * M_PI, 1e-6);
  // The radius grows with the centre held: the axis moves, and the area by 2 pi r.
  EXPECT_NEAR(room.area_stddev_m2, 2.0 * M_PI * 2.0 * 0.001, 1e-4);
}

TEST(RoomMeasures, UnseenEdgesAreTold) {
  Room room = SquareRoom();
  room.loops[0][2].closed_m = 0.5;
  MeasureRoom(
      PlaneCovariance(SquareWalls(), Eigen::MatrixXd::Zero(8, 8)), StoreyLevel(), &room);
  EXPECT_NEAR(room.unseen_m, 1.5, 1e-12);
  EXPECT_NEAR(room.area_stddev_m2, 1.5 * 0.1, 1e-12);
  EXPECT_NEAR(room.perimeter_m, 8.0, 1e-12);
}

TEST(RoomMeasures, WallsLieBetweenEdgesThatLookAway) {
  Room west = SquareRoom();
  Room east = SquareRoom();
  std::vector<PlanePatch> planes = SquareWalls();
  for (RoomEdge& edge : east.loops[0]) {
    edge.from.x() += 2.3;
    edge.plane_id += 4;
  }
  for (PlanePatch plane : SquareWalls()) {
    plane.id += 4;
    plane.distance += 2.3 * plane.normal.x();
    planes.push_back(plane);
  }
  const PlaneCovariance covariance(planes, Eigen::MatrixXd::Identity(16, 16) * 1e-6);
  const std::vector<WallPiece> walls = FindWalls(covariance, StoreyLevel(), {west, east});
  ASSERT_THAT(walls, SizeIs(1));
  EXPECT_NEAR(walls[0].thickness_m, 0.3, 1e-12);
  EXPECT_EQ(walls[0].plane_a, 1);
  EXPECT_EQ(walls[0].plane_b, 7);
  EXPECT_GT(walls[0].stddev_m, 1e-3);
}

TEST(RoomOutlines, InsideAndArea) {
  const Room room = SquareRoom();
  EXPECT_NEAR(LoopArea(room.loops[0]), 4.0, 1e-12);
  EXPECT_TRUE(IsInside(room.loops, {0.9, -0.9}));
  EXPECT_FALSE(IsInside(room.loops, {1.1, 0.0}));
}

}  // namespace
}  // namespace plumbline
