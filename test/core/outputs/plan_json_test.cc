#include "core/outputs/plan_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "test/core/outputs/plan_of_rooms.h"

namespace plumbline {
namespace {

using Json = nlohmann::json;

TEST(FormatRoomsTest, RoomsStandWithTheirMeasures) {
  const Json json = Json::parse(FormatRooms(PlanOfRooms()));
  EXPECT_EQ(json["verdict"], "consistent");
  EXPECT_EQ(json["recording"], "office.bag");
  ASSERT_EQ(json["storeys"].size(), 1u);
  const Json& storey = json["storeys"][0];
  EXPECT_EQ(storey["storey"], 1);
  EXPECT_EQ(storey["floor_m"], -1.2);
  const Json& room = storey["rooms"][0];
  EXPECT_EQ(room["number"], 1);
  EXPECT_EQ(room["entered"], true);
  EXPECT_EQ(room["area_m2"], 11.0);  // to the square centimetre
  EXPECT_EQ(room["sigma_area_m2"], 0.0124);
  EXPECT_EQ(room["height_m"], 2.5);
  EXPECT_EQ(room["outline"], Json::parse("[[0.0,0.0],[4.0,0.0],[4.0,3.0],[0.0,3.0]]"));
  EXPECT_EQ(room["outline_planes"], Json::parse("[10,11,12,13]"));
  EXPECT_EQ(room["holes"], Json::parse("[[[1.0,1.0],[1.0,2.0],[2.0,2.0],[2.0,1.0]]]"));
}

TEST(FormatRoomsTest, WhatIsNotKnownIsNull) {
  FloorPlans plan = PlanOfRooms();
  plan.origin = {};
  plan.storeys[0].level.has_floor = false;
  PlanDoor door;
  door.rooms[0] = 2;
  plan.storeys[0].doors.push_back(door);
  const Json json = Json::parse(FormatRooms(plan));
  for (const char* name : {"verdict", "recording", "version", "date"}) {
    EXPECT_TRUE(json[name].is_null()) << name;
  }
  const Json& storey = json["storeys"][0];
  EXPECT_TRUE(storey["floor_m"].is_null());
  for (const char* name : {"floor_m", "height_m", "sigma_height_m"}) {
    EXPECT_TRUE(storey["rooms"][1][name].is_null()) << name;
  }
  EXPECT_EQ(storey["doors"][0]["rooms"], Json::parse("[2,null]"));
  EXPECT_TRUE(storey["doors"][0]["depth_m"].is_null());
}

TEST(FormatRoomsTest, DoorsWindowsWallsAndDimensionsAreListed) {
  FloorPlans plan = PlanOfRooms();
  StoreyPlan& storey = plan.storeys[0];
  PlanDoor door;
  door.from = {1.0, 3.0};
  door.to = {1.9, 3.0};
  door.width_m = 0.9;
  door.depth_m = 0.12345;
  door.plane_id = 12;
  door.rooms[0] = 1;
  door.rooms[1] = 2;
  storey.doors.push_back(door);
  PlanWindow window;
  window.from = {4.0, 1.0};
  window.to = {4.0, 2.5};
  window.reaches_floor = true;
  storey.windows.push_back(window);
  WallPiece wall;
  wall.corners = {{0.0, 3.0}, {1.0, 3.0}, {1.0, 3.1}, {0.0, 3.1}};
  wall.plane_a = 12;
  wall.plane_b = 30;
  wall.thickness_m = 0.1;
  storey.walls.push_back(wall);
  storey.rooms[0].dimensions.push_back({{0.0, 1.5}, {4.0, 1.5}, 13, 11, 4.0, 0.0005});
  storey.rooms[0].floor_openings.push_back(
      {1.5, 0.02, Eigen::AlignedBox2d(Eigen::Vector2d(2.5, 0.5), Eigen::Vector2d(3.5, 2.0))});
  const Json json = Json::parse(FormatRooms(plan))["storeys"][0];
  EXPECT_EQ(json["doors"][0]["depth_m"], 0.1235);  // to a tenth of a millimetre
  EXPECT_EQ(json["doors"][0]["rooms"], Json::parse("[1,2]"));
  EXPECT_EQ(json["windows"][0]["width_m"], 1.5);
  EXPECT_EQ(json["windows"][0]["reaches_floor"], true);
  EXPECT_EQ(json["walls"][0]["planes"], Json::parse("[12,30]"));
  EXPECT_EQ(json["walls"][0]["corners"].size(), 4u);
  const Json& room = json["rooms"][0];
  EXPECT_EQ(room["dimensions"][0]["planes"], Json::parse("[13,11]"));
  EXPECT_EQ(room["dimensions"][0]["sigma_m"], 0.0005);
  EXPECT_EQ(room["floor_openings"][0]["to"], Json::parse("[3.5,2.0]"));
}

TEST(FormatRoomsTest, NameThatIsNoUtf8IsStillJson) {
  FloorPlans plan = PlanOfRooms();
  plan.origin.recording = "b\xfcro.bag";
  EXPECT_EQ(Json::parse(FormatRooms(plan))["recording"], "b\xef\xbf\xbdro.bag");
}

}  // namespace
}  // namespace plumbline
