#include "core/outputs/floor_plan_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/result/result_files.h"
#include "test/testing/made_up_rooms.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

std::string ContentOf(const std::vector<PlanFile>& files, const std::string& name) {
  for (const PlanFile& file : files) {
    if (file.name == name) return file.content;
  }
  return "";
}

const std::vector<PlanFile>& Files() {
  static const std::vector<PlanFile> files = FloorPlanFiles(MakeFloorPlan(TwoMadeUpRooms()));
  return files;
}

TEST(FloorPlanFiles, BelongToTheResult) {
  std::set<std::string> names;
  for (const PlanFile& file : Files()) {
    names.insert(file.name);
    EXPECT_TRUE(IsResultFile(file.name)) << file.name;
  }
  EXPECT_THAT(names,
              ::testing::ElementsAre(
                  "building.city.json", "floor_plan.dxf", "floor_plan.svg", "rooms.json"));
  EXPECT_TRUE(IsResultFile("floor_plan_2.svg"));
  EXPECT_FALSE(IsResultFile("floor_plan_old.svg"));
  EXPECT_FALSE(IsResultFile("floor_plan.png"));
  EXPECT_FALSE(IsResultFile("my_floor_plan.svg"));
}

TEST(FloorPlanFiles, TheSamePlanGivesTheSameBytes) {
  const std::vector<PlanFile> again = FloorPlanFiles(MakeFloorPlan(TwoMadeUpRooms()));
  for (const PlanFile& file : Files()) EXPECT_EQ(file.content, ContentOf(again, file.name));
}

// The files of a map with this verdict.
std::vector<PlanFile> FilesOf(const std::string& verdict) {
  FloorPlanInput input = TwoMadeUpRooms();
  input.origin = {verdict, "a<b.bag", "1.2.3", "2026-11-27"};
  return FloorPlanFiles(MakeFloorPlan(input));
}

TEST(FloorPlanFiles, SayOfWhatMapTheyAreAndWhetherItMayBeTrusted) {
  const std::vector<PlanFile> files = FilesOf("contradictory");
  const Json rooms = Json::parse(ContentOf(files, "rooms.json"));
  EXPECT_EQ(rooms.at("verdict"), "contradictory");
  EXPECT_EQ(rooms.at("recording"), "a<b.bag");
  EXPECT_EQ(rooms.at("version"), "1.2.3");
  EXPECT_EQ(rooms.at("date"), "2026-11-27");
  const Json city = Json::parse(ContentOf(files, "building.city.json"));
  EXPECT_EQ(city.at("metadata").at("referenceDate"), "2026-11-27");
  const Json& building = city.at("CityObjects").at("building").at("attributes");
  EXPECT_EQ(building.at("verdict"), "contradictory");
  const std::string svg = ContentOf(files, "floor_plan.svg");
  EXPECT_THAT(svg, HasSubstr("a&lt;b.bag, 2026-11-27: contradictory. plumbline 1.2.3"));
  EXPECT_THAT(svg, HasSubstr("id=\"warning\""));
  const std::string dxf = ContentOf(files, "floor_plan.dxf");
  EXPECT_THAT(dxf, HasSubstr("a<b.bag, 2026-11-27: contradictory. plumbline 1.2.3"));
  EXPECT_THAT(dxf, HasSubstr("do not use it"));
}

TEST(FloorPlanFiles, DoNotWarnOfAConsistentMap) {
  const std::vector<PlanFile> files = FilesOf("consistent");
  EXPECT_THAT(ContentOf(files, "floor_plan.svg"), HasSubstr(": consistent."));
  EXPECT_THAT(ContentOf(files, "floor_plan.svg"), Not(HasSubstr("id=\"warning\"")));
  EXPECT_THAT(ContentOf(files, "floor_plan.dxf"), Not(HasSubstr("do not use it")));
}

TEST(FloorPlanFiles, TheDrawingIsInMetresAndHasItsOuterWallsOnTheirLayer) {
  const std::string dxf = ContentOf(Files(), "floor_plan.dxf");
  EXPECT_THAT(dxf, HasSubstr("9\n$INSUNITS\n70\n6\n"));
  // The west wall of the first room, of which one face was seen, from corner to corner.
  EXPECT_THAT(dxf,
              HasSubstr("0\nLINE\n8\nWALLS\n10\n0.0000\n20\n3.0000\n30\n0.0000\n11\n0.0000\n"
                        "21\n0.0000\n"));
}

TEST(FloorPlanFiles, RoomsHoldAreasDimensionsAndDoors) {
  const Json json = Json::parse(ContentOf(Files(), "rooms.json"));
  const Json& storey = json.at("storeys").at(0);
  ASSERT_EQ(storey.at("rooms").size(), 2u);
  const Json& room = storey["rooms"][0];
  EXPECT_EQ(room.at("number"), 1);
  EXPECT_NEAR(room.at("area_m2").get<double>(), 12.0, 1e-3);
  EXPECT_NEAR(room.at("sigma_area_m2").get<double>(), 0.0141, 1e-4);
  EXPECT_NEAR(room.at("height_m").get<double>(), 2.5, 1e-4);
  EXPECT_EQ(room.at("outline").size(), room.at("outline_planes").size());
  EXPECT_EQ(room.at("dimensions").size(), 2u);
  EXPECT_EQ(storey.at("doors").size(), 1u);
  EXPECT_NEAR(storey["walls"].at(0).at("thickness_m").get<double>(), 0.2, 1e-4);
}

// The volume that a shell's surfaces enclose, by their triangles as seen from outside.
double VolumeOf(const Json& shell, const Json& vertices, double scale) {
  std::vector<Eigen::Vector3d> points;
  for (const Json& v : vertices) {
    points.emplace_back(
        v[0].get<double>() * scale, v[1].get<double>() * scale, v[2].get<double>() * scale);
  }
  double six_times = 0.0;
  for (const Json& surface : shell) {
    for (const Json& ring : surface) {
      const auto corners = ring.get<std::vector<size_t>>();
      for (size_t i = 1; i + 1 < corners.size(); ++i) {
        Eigen::Matrix3d edges;
        edges << points[corners[0]], points[corners[i]], points[corners[i + 1]];
        six_times += edges.determinant();
      }
    }
  }
  return six_times / 6.0;
}

TEST(FloorPlanFiles, CityJsonRoomsAreSolidsThatLookOutwards) {
  const Json json = Json::parse(ContentOf(Files(), "building.city.json"));
  EXPECT_EQ(json.at("version"), "2.0");
  const Json& room = json.at("CityObjects").at("storey_1_room_1");
  EXPECT_EQ(room.at("type"), "BuildingRoom");
  EXPECT_EQ(room.at("parents").at(0), "storey_1");
  const Json& geometry = room.at("geometry").at(0);
  ASSERT_EQ(geometry.at("type"), "Solid");
  const Json& shell = geometry.at("boundaries").at(0);
  EXPECT_EQ(shell.size(), geometry.at("semantics").at("values").at(0).size());
  EXPECT_NEAR(VolumeOf(shell, json.at("vertices"), json.at("transform").at("scale").at(0)),
              12.0 * 2.5,
              0.01);
}

TEST(FloorPlanFiles, ARoomWithoutACeilingIsAFloorInCityJson) {
  FloorPlans plan = MakeFloorPlan(TwoMadeUpRooms());
  plan.storeys[0].rooms[1].ceiling_m.reset();
  const Json json = Json::parse(ContentOf(FloorPlanFiles(plan), "building.city.json"));
  const Json& geometry = json.at("CityObjects").at("storey_1_room_2").at("geometry").at(0);
  EXPECT_EQ(geometry.at("type"), "MultiSurface");
  ASSERT_EQ(geometry.at("boundaries").size(), 1u);
  EXPECT_EQ(geometry["boundaries"][0].at(0).size(), 4u);
  EXPECT_EQ(geometry.at("semantics").at("surfaces").at(0).at("type"), "FloorSurface");
}

TEST(FloorPlanFiles, DrawingsShowRoomsAndDoors) {
  const std::string svg = ContentOf(Files(), "floor_plan.svg");
  EXPECT_THAT(svg, HasSubstr("12.00 m\u00b2"));
  EXPECT_THAT(svg, HasSubstr("9.00 m\u00b2"));
  EXPECT_THAT(svg, HasSubstr("Scale 1:20"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  const std::string dxf = ContentOf(Files(), "floor_plan.dxf");
  EXPECT_THAT(dxf, HasSubstr("AC1009"));
  EXPECT_THAT(dxf, HasSubstr("\nDOORS\n"));
  EXPECT_THAT(dxf, ::testing::EndsWith("0\nEOF\n"));
}

TEST(RoomTable, NamesEveryRoom) {
  const std::string table = RoomTable(MakeFloorPlan(TwoMadeUpRooms()));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3);
  EXPECT_THAT(table, HasSubstr("12.00"));
}

}  // namespace
}  // namespace plumbline
