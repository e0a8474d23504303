#include "core/outputs/floor_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/outputs/map_cloud.h"
#include "core/outputs/plan_drawing.h"
#include "core/outputs/room_outlines.h"
#include "test/testing/made_up_rooms.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr double kToleranceM = 1e-5;  // points are floats

// One room of 5 m x 4 m with a pillar of 0.4 m x 0.3 m, of which two sides are seen.
MadeUpRooms RoomWithPillar() {
  MadeUpRooms rooms;
  rooms.AddBox({0, 0}, {5, 4});
  rooms.AddFace({2.4, 2.0}, {2.0, 2.0});
  rooms.AddFace({2.0, 2.0}, {2.0, 2.3});
  return rooms;
}

TEST(FloorPlan, TwoRoomsAndTheDoorBetweenThem) {
  const FloorPlans plan = MakeFloorPlan(TwoMadeUpRooms());
  ASSERT_THAT(plan.storeys, SizeIs(1));
  const StoreyPlan& storey = plan.storeys[0];
  ASSERT_THAT(storey.rooms, SizeIs(2));
  // In the order in which the rig came to them.
  EXPECT_NEAR(storey.rooms[0].area_m2, 12.0, 12.0 * kToleranceM);
  EXPECT_NEAR(storey.rooms[1].area_m2, 9.0, 9.0 * kToleranceM);
  for (const Room& room : storey.rooms) {
    EXPECT_TRUE(room.entered);
    ASSERT_THAT(room.loops, SizeIs(1));
    EXPECT_THAT(room.loops[0], SizeIs(4));
    EXPECT_NEAR(*room.ceiling_m - *room.floor_m, MadeUpRooms::kCeilingM, kToleranceM);
    EXPECT_NEAR(*room.height_stddev_m, std::sqrt(2.0) * MadeUpRooms::kFloorStddevM, 1e-9);
  }
  ASSERT_THAT(storey.doors, SizeIs(1));
  const PlanDoor& door = storey.doors[0];
  EXPECT_NEAR(door.width_m, 0.9, 0.03);
  EXPECT_NEAR(door.depth_m, 0.2, kToleranceM);
  EXPECT_EQ(door.rooms[0] + door.rooms[1], 3);
  ASSERT_THAT(storey.walls, SizeIs(1));
  EXPECT_NEAR(storey.walls[0].thickness_m, 0.2, kToleranceM);
  EXPECT_NEAR(storey.walls[0].stddev_m, std::sqrt(2.0) * MadeUpRooms::kWallStddevM, 1e-9);
}

TEST(FloorPlan, AreasCarryTheStandardDeviationsOfTheirWalls) {
  const FloorPlans plan = MakeFloorPlan(TwoMadeUpRooms());
  // Each wall moves the area by its length: 4, 3, 4, 3 m and 3, 3, 3, 3 m.
  const std::vector<Room>& rooms = plan.storeys.at(0).rooms;
  EXPECT_NEAR(rooms[0].area_stddev_m2, MadeUpRooms::kWallStddevM * std::sqrt(50.0), 1e-6);
  EXPECT_NEAR(rooms[1].area_stddev_m2, MadeUpRooms::kWallStddevM * std::sqrt(36.0), 1e-6);
}

TEST(FloorPlan, DimensionsAreClearDistancesOfOppositeWalls) {
  const FloorPlans plan = MakeFloorPlan(TwoMadeUpRooms());
  const Room& room = plan.storeys.at(0).rooms.at(0);
  ASSERT_THAT(room.dimensions, SizeIs(2));
  std::vector<double> lengths;
  for (const Dimension& dimension : room.dimensions) {
    lengths.push_back(dimension.length_m);
    EXPECT_NEAR(dimension.stddev_m, std::sqrt(2.0) * MadeUpRooms::kWallStddevM, 1e-9);
    EXPECT_TRUE(IsInside(room.loops, 0.5 * (dimension.from + dimension.to)));
  }
  EXPECT_THAT(lengths,
              ::testing::UnorderedElementsAre(::testing::DoubleNear(4.0, kToleranceM),
                                              ::testing::DoubleNear(3.0, kToleranceM)));
}

TEST(FloorPlan, APillarOfWhichTwoSidesAreSeenIsNoFloor) {
  MadeUpRooms rooms = RoomWithPillar();
  rooms.AddWay({{1, 1}, {1, 3}, {1.5, 1}, {4, 1}, {4, 3}});
  const FloorPlans plan = MakeFloorPlan(rooms.Input());
  ASSERT_THAT(plan.storeys.at(0).rooms, SizeIs(1));
  const Room& room = plan.storeys[0].rooms[0];
  EXPECT_THAT(room.loops, SizeIs(2));
  EXPECT_NEAR(
      room.area_m2, 20.0 - 0.4 * 0.3, 0.02);  // its ends are known to the beams' spacing
}

TEST(FloorPlan, AHiddenPieceOfAWallIsBridged) {
  MadeUpRooms rooms;
  // No beam ends on the wall between 1 m and 2.4 m: something as high as the room stands
  // there.
  rooms.AddFace({0, 0}, {1, 0});
  rooms.AddFace({2.4, 0}, {5, 0});
  rooms.AddFace({5, 0}, {5, 4});
  rooms.AddFace({5, 4}, {0, 4});
  rooms.AddFace({0, 4}, {0, 0});
  rooms.AddFace({1, 0}, {1, 0.05});
  rooms.AddWay({{1, 2}, {4, 2}});
  FloorPlanInput input = rooms.Input();
  for (CloudPoint& point : input.points) {
    // What went through the hole ends before it, on nothing.
    if (point.p_world.y() > -0.001f) continue;
    const Eigen::Vector2f origin = input.poses[static_cast<size_t>(point.time_s * 10.0 + 0.5)]
                                       .world_from_body.translation.head<2>()
                                       .cast<float>();
    const float share = (origin.y() - 0.3f) / (origin.y() - point.p_world.y());
    point.p_world.head<2>() = origin + share * (point.p_world.head<2>() - origin);
    point.plane_id = -1;
  }
  const FloorPlans plan = MakeFloorPlan(input);
  ASSERT_THAT(plan.storeys.at(0).rooms, SizeIs(1));
  EXPECT_NEAR(plan.storeys[0].rooms[0].area_m2, 20.0, 1e-3);
  EXPECT_THAT(plan.storeys[0].doors, SizeIs(0));
}

TEST(FloorPlan, WhatIsSeenThroughAnOpeningToTheOutsideIsNoRoom) {
  MadeUpRooms rooms;
  // 3 m of the wall are glass without a lintel, and the ground goes on outside.
  rooms.AddFace({0, 0}, {1, 0});
  rooms.AddFace({4, 0}, {5, 0});
  rooms.AddFace({5, 0}, {5, 4});
  rooms.AddFace({5, 4}, {0, 4});
  rooms.AddFace({0, 4}, {0, 0});
  rooms.AddWay({{1, 2}, {4, 2}, {2.5, 0.5}});
  const FloorPlans plan = MakeFloorPlan(rooms.Input());
  ASSERT_THAT(plan.storeys.at(0).rooms, SizeIs(1));
  EXPECT_NEAR(plan.storeys[0].rooms[0].area_m2, 20.0, 1e-3);
}

TEST(FloorPlan, ACorridorGoesOnAsFarAsItsWallsWereSeen) {
  MadeUpRooms rooms;
  // Its east end was not seen; a step in its north wall cuts it in two where the rig was in
  // the west half only.
  rooms.AddFace({0, 0}, {12, 0});
  rooms.AddFace({12, 2.5}, {6, 2.5});
  rooms.AddFace({6, 2.5}, {6, 2});
  rooms.AddFace({6, 2}, {0, 2});
  rooms.AddFace({0, 2}, {0, 0});
  rooms.AddWay({{1, 1}, {5, 1}});
  const FloorPlans plan = MakeFloorPlan(rooms.Input());
  ASSERT_THAT(plan.storeys.at(0).rooms, SizeIs(1));
  EXPECT_NEAR(plan.storeys[0].rooms[0].area_m2, 6.0 * 2.0 + 6.0 * 2.5, 0.5);
}

// The area of a room of 5 m x 4 m whose north-east corner is cut, with a cupboard before its
// north wall: in a niche, or free on its west side.
double AreaWithCupboard(bool in_niche) {
  constexpr double kTopM = 2.1;
  MadeUpRooms rooms;
  const double west = in_niche ? 1.0 : 0.0;
  rooms.AddFace({0, 0}, {5, 0});
  rooms.AddFace({5, 0}, {5, 3.5});
  rooms.AddFace({5, 3.5}, {3, 3.5});
  rooms.AddFace({3, 3.5}, {3, 4});
  rooms.AddFace({3, 4}, {west, 4});
  if (in_niche) {
    rooms.AddFace({1, 4}, {1, 3.5});
    rooms.AddFace({1, 3.5}, {0, 3.5});
  }
  rooms.AddFace({0, in_niche ? 3.5 : 4.0}, {0, 0});
  rooms.AddFront({3, 3.48}, {1, 3.48}, kTopM);
  if (!in_niche) rooms.AddFront({1, 3.48}, {1, 4}, kTopM);
  rooms.AddWay({{1, 1}, {4, 1}, {4, 2.5}, {1, 2.5}});
  const FloorPlans plan = MakeFloorPlan(rooms.Input());
  EXPECT_THAT(plan.storeys.at(0).rooms, SizeIs(1));
  return plan.storeys[0].rooms.at(0).area_m2;
}

TEST(FloorPlan, ACupboardInANicheIsNoWall) {
  EXPECT_NEAR(AreaWithCupboard(true), 5.0 * 3.5 + 2.0 * 0.5, 0.01);
}

TEST(FloorPlan, ACupboardBeforeAWallIsNone) {
  EXPECT_NEAR(AreaWithCupboard(false), 5.0 * 3.5 + 3.0 * 0.5, 0.01);
}

// Whether a drawing of the storey shows a wall at a place: a solid without a door.
bool IsDrawnSolid(const StoreyPlan& storey, const Eigen::Vector2d& p) {
  const auto is_in = [&p](const std::vector<Eigen::Vector2d>& corners) {
    RoomLoop loop;
    for (const Eigen::Vector2d& corner : corners) loop.push_back({corner, -1, 0.0});
    return IsInside({loop}, p);
  };
  const bool in_door =
      std::any_of(storey.doors.begin(), storey.doors.end(), [&](const PlanDoor& door) {
        return is_in(GapCorners(door));
      });
  bool in_solid = false;
  for (const auto& outline : storey.solids) in_solid ^= is_in(outline);
  return in_solid && !in_door;
}

TEST(FloorPlan, AWallHasItsDoorWhereThereIsAWayRoundItToo) {
  MadeUpRooms rooms;
  rooms.AddBox({0, 0}, {8, 4.2});
  // A wall of 0.2 m that ends 2 m before the north wall, with a door of 0.9 m.
  rooms.AddFace({4, 0}, {4, 2.2}, 0.6, 1.5);
  rooms.AddFace({4.2, 2.2}, {4.2, 0}, 0.7, 1.6);
  rooms.AddFace({4, 2.2}, {4.2, 2.2});
  rooms.AddWay({{1, 1}, {7, 1.05}, {7, 3.2}, {1, 3.2}, {1, 2}});
  const FloorPlanInput input = rooms.Input();
  const FloorPlans plan = MakeFloorPlan(input);
  const StoreyPlan& storey = plan.storeys.at(0);
  ASSERT_THAT(storey.rooms, SizeIs(1));
  ASSERT_THAT(storey.doors, SizeIs(1));
  EXPECT_NEAR(storey.doors[0].width_m, 0.9, 0.03);
  EXPECT_EQ(storey.doors[0].rooms[0], 1);
  EXPECT_EQ(storey.doors[0].rooms[1], 1);
  EXPECT_TRUE(IsDrawnSolid(storey, {4.1, 0.3}));
  EXPECT_TRUE(IsDrawnSolid(storey, {4.1, 1.9}));
  for (const StampedPose& pose : input.poses) {
    const Eigen::Vector2d p = pose.world_from_body.translation.head<2>();
    EXPECT_FALSE(IsDrawnSolid(storey, p)) << p.transpose();
  }
}

TEST(FloorPlan, PointsFarFromEverythingChangeNoRoom) {
  FloorPlanInput input = TwoMadeUpRooms();
  const FloorPlans before = MakeFloorPlan(input);
  for (size_t i = 0; i < 200; ++i) {
    input.points[50 * i].p_world += Eigen::Vector3f(1000.0f, 1000.0f, 0.0f);
  }
  const FloorPlans after = MakeFloorPlan(input);
  ASSERT_EQ(after.storeys.size(), 1u);
  ASSERT_EQ(after.storeys[0].rooms.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(after.storeys[0].rooms[i].area_m2, before.storeys[0].rooms[i].area_m2, 1e-6);
  }
}

// A room of 5 m x 4 m with openings in its east wall; nobody goes through them.
class OpeningsTest : public testing::Test {
 protected:
  OpeningsTest() {
    rooms_.AddFace({0, 0}, {5, 0});
    rooms_.AddFace({5, 4}, {0, 4});
    rooms_.AddFace({0, 4}, {0, 0});
    rooms_.AddWay({{1, 1}, {3, 1.45}, {3, 2.5}, {1, 3}});
  }
  StoreyPlan Plan() const { return MakeFloorPlan(rooms_.Input()).storeys.at(0); }

  MadeUpRooms rooms_;
};

struct OpeningCase {
  double width_m;
  double sill_m;
  bool is_outdoors;  // beams that go through meet no ceiling
};

class OneOpeningTest : public OpeningsTest, public testing::WithParamInterface<OpeningCase> {};

TEST_P(OneOpeningTest, IsAWindowWhereItHasASillOrLeadsOutdoors) {
  const OpeningCase& one = GetParam();
  rooms_.AddWindow({5, 0}, {5, 4}, 1.0, 1.0 + one.width_m, one.sill_m);
  if (one.is_outdoors) rooms_.SetRoof({0, 0}, {5, 4});
  const StoreyPlan storey = Plan();
  if (one.sill_m > 0.0 || one.is_outdoors) {
    EXPECT_TRUE(storey.doors.empty());
    ASSERT_EQ(storey.windows.size(), 1u);
    const PlanWindow& window = storey.windows[0];
    EXPECT_NEAR((window.to - window.from).norm(), one.width_m, 3.0 * window.width_stddev_m);
    EXPECT_LT(window.width_stddev_m, 0.05);
    EXPECT_EQ(window.reaches_floor, one.sill_m == 0.0);
  } else {
    EXPECT_TRUE(storey.windows.empty());
    ASSERT_EQ(storey.doors.size(), 1u);
    EXPECT_NEAR(storey.doors[0].width_m, one.width_m, 3.0 * storey.doors[0].width_stddev_m);
    EXPECT_TRUE(storey.doors[0].reaches_floor);
  }
}

INSTANTIATE_TEST_SUITE_P(All,
                         OneOpeningTest,
                         testing::Values(OpeningCase{0.9, 0.0, false},
                                         OpeningCase{0.9, 0.0, true},
                                         OpeningCase{0.9, 0.9, false},
                                         OpeningCase{1.2, 0.0, true},
                                         OpeningCase{1.2, 0.9, true},
                                         OpeningCase{2.4, 0.0, false},
                                         OpeningCase{2.4, 0.0, true},
                                         OpeningCase{2.4, 0.9, false}));

TEST_F(OpeningsTest, PanesBesideAPostAreOneWindow) {
  rooms_.AddWindow({5, 0}, {5, 2.0}, 1.0, 1.9, 0.0);
  rooms_.AddWindow({5, 2.0}, {5, 4}, 0.0, 0.4, 0.0);
  rooms_.SetRoof({0, 0}, {5, 4});
  const StoreyPlan storey = Plan();
  EXPECT_TRUE(storey.doors.empty());
  ASSERT_EQ(storey.windows.size(), 1u);
  const PlanWindow& window = storey.windows[0];
  EXPECT_NEAR((window.to - window.from).norm(), 1.4, 3.0 * window.width_stddev_m);
  EXPECT_TRUE(window.reaches_floor);
}

TEST(FloorPlan, AnOpeningInTheFloorIsNoArea) {
  FloorPlanInput input = TwoMadeUpRooms();
  const double before_m2 = MakeFloorPlan(input).storeys.at(0).rooms.at(0).area_m2;
  // Beams that ended on the floor from x 2 to 3.5, y 0.5 to 1.5 go on to one 2.8 m below.
  const Eigen::AlignedBox2f hole(Eigen::Vector2f(2.0f, 0.5f), Eigen::Vector2f(3.5f, 1.5f));
  const BeamOrigins origins(input.rig, input.poses, input.start_ns);
  int num_through = 0;
  for (CloudPoint& point : input.points) {
    if (point.plane_id != 0 || !hole.contains(point.p_world.head<2>())) continue;
    const Eigen::Vector3f from = origins.At(0, point.time_s)->cast<float>();
    const float share = (from.z() + 2.8f) / from.z();
    point.p_world = from + share * (point.p_world - from);
    point.plane_id = -1;
    ++num_through;
  }
  ASSERT_GT(num_through, 100);
  const Room room = MakeFloorPlan(input).storeys.at(0).rooms.at(0);
  ASSERT_EQ(room.floor_openings.size(), 1u);
  EXPECT_NEAR(room.floor_openings[0].area_m2, 1.5, 2.0 * room.floor_openings[0].stddev_m2);
  EXPECT_LT(room.floor_openings[0].stddev_m2, 0.25);
  EXPECT_NEAR(room.area_m2, before_m2 - room.floor_openings[0].area_m2, 1e-9);
  EXPECT_NEAR(room.floor_openings[0].box.min().x(), 2.0, 0.15);
  EXPECT_NEAR(room.floor_openings[0].box.max().y(), 1.5, 0.15);
}

TEST(FloorPlan, AMapWithoutWallsHasNone) {
  MadeUpRooms rooms;
  rooms.AddWay({{1, 2}, {4, 2}});
  EXPECT_THAT(ErrorOf([&] { MakeFloorPlan(rooms.Input()); }), HasSubstr("no room"));
}

TEST(FloorPlan, StoreysLieAboveEachOther) {
  FloorPlanInput input = TwoMadeUpRooms();
  const FloorPlanInput below = input;
  constexpr double kRiseM = 3.0;
  // The same once more, one storey higher and later.
  std::vector<PlanePatch> planes = input.planes.planes();
  const int num_ids = static_cast<int>(planes.size());
  for (PlanePatch plane : below.planes.planes()) {
    plane.id += num_ids;
    plane.distance += kRiseM * plane.normal.z();
    plane.centre.z() += kRiseM;
    plane.first_time_ns += 1'000'000'000'000;
    for (Eigen::Vector3d& corner : plane.outline) corner.z() += kRiseM;
    planes.push_back(plane);
  }
  const Eigen::Index size = below.planes.covariance().rows();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(2 * size, 2 * size);
  covariance.topLeftCorner(size, size) = below.planes.covariance();
  covariance.bottomRightCorner(size, size) = below.planes.covariance();
  input.planes = PlaneCovariance(planes, covariance);
  for (StampedPose pose : below.poses) {
    pose.time_ns += 1'000'000'000'000;
    pose.world_from_body.translation.z() += kRiseM;
    input.poses.push_back(pose);
  }
  for (CloudPoint point : below.points) {
    point.time_s += 1000.0;
    point.p_world.z() += static_cast<float>(kRiseM);
    if (point.plane_id >= 0) point.plane_id += num_ids;
    input.points.push_back(point);
  }
  const FloorPlans plan = MakeFloorPlan(input);
  ASSERT_THAT(plan.storeys, SizeIs(2));
  for (const StoreyPlan& storey : plan.storeys) {
    ASSERT_THAT(storey.rooms, SizeIs(2));
    EXPECT_NEAR(storey.rooms[0].area_m2, 12.0, 12.0 * kToleranceM);
  }
  EXPECT_NEAR(*plan.storeys[1].rooms[0].floor_m, kRiseM, kToleranceM);
}

}  // namespace
}  // namespace plumbline
