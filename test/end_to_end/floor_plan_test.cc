#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/outputs/floor_plan_files.h"
#include "test/testing/scenario.h"
#include "test/testing/svg_texts.h"

namespace plumbline {
namespace {

using Json = nlohmann::json;

// Two rooms with a wall of 0.15 m between them, a door of 0.9 m in it and a pillar.
Scenario TwoRooms() {
  Scenario scenario;
  scenario.building = R"(floor_height_m: 0.0
ceiling_height_m: 2.6
outlines: [{corners: [[0, 0], [7.4, 0], [7.4, 4.1], [0, 4.1]]}]
solids: [{corners: [[5.3, 2.3], [5.7, 2.3], [5.7, 2.7], [5.3, 2.7]]}]
walls:
  - from: [4.0, 0]
    to: [4.0, 4.1]
    thickness_m: 0.15
    openings: [{position_m: 1.4, width_m: 0.9, height_m: 2.05}]
)";
  scenario.scanners = TiltedRig();
  for (ScenarioScanner& scanner : scenario.scanners) scanner.beams = 270;
  scenario.path = R"(path:
  way_points: [[1.0, 3.0], [1.0, 1.4], [6.6, 1.4], [6.6, 3.4], [4.7, 3.4], [4.7, 1.4]]
  corner_radius_m: 0.4
  body_height_m: 1.4
speed_m_s: 0.8
)";
  return scenario;
}

constexpr double kWestM2 = 3.925 * 4.1;
constexpr double kEastM2 = 3.325 * 4.1 - 0.4 * 0.4;

class FloorPlanEndToEndTest : public MappingTest {};

TEST_F(FloorPlanEndToEndTest, TwoRoomsAreFoundWithTheirAreas) {
  WriteRecording(Simulate(TwoRooms()));
  MapJob job = Job();
  job.floor_plan = true;
  RunMapJob(job, [](double) {});
  const Json json = Json::parse(ReadBytes(Path("result/rooms.json")));
  const Json& storey = json.at("storeys").at(0);
  ASSERT_EQ(storey.at("rooms").size(), 2u);
  const double true_m2[] = {kWestM2, kEastM2};
  for (size_t i = 0; i < 2; ++i) {
    const Json& room = storey["rooms"][i];
    EXPECT_TRUE(room.at("entered").get<bool>());
    EXPECT_NEAR(room.at("area_m2").get<double>(), true_m2[i], 0.005 * true_m2[i]);
    EXPECT_NEAR(room.at("height_m").get<double>(), 2.6, 0.01);
  }
  // Four walls without anything in between: the area is right to within its own deviation.
  EXPECT_NEAR(storey["rooms"][0].at("area_m2").get<double>(),
              kWestM2,
              4.0 * storey["rooms"][0].at("sigma_area_m2").get<double>());
  ASSERT_EQ(storey.at("doors").size(), 1u);
  EXPECT_NEAR(storey["doors"][0].at("width_m").get<double>(), 0.9, 0.06);
  EXPECT_NEAR(storey["doors"][0].at("depth_m").get<double>(), 0.15, 0.01);

  EXPECT_THAT(OverlapsIn(ReadBytes(Path("result/floor_plan.svg"))), ::testing::IsEmpty());

  // The program makes the same of the finished result.
  RunPlanJob(Path("result"), Path("rig.yaml"), Path("later"));
  for (const char* name :
       {"rooms.json", "building.city.json", "floor_plan.svg", "floor_plan.dxf"}) {
    EXPECT_EQ(ReadBytes(Path(std::string("later/") + name)),
              ReadBytes(Path(std::string("result/") + name)))
        << name;
  }
}

// Two rooms with a door between them, and a hall at another height up a ramp.
Scenario SplitLevel(double step_m) {
  Scenario scenario;
  const std::string step = std::to_string(step_m);
  scenario.building = R"(floor_height_m: 0.0
ceiling_height_m: 2.8
outlines:
  - corners: [[0, 0], [7, 0], [7, 5], [0, 5]]
  - floor_height_m: )" +
                      step + R"(
    ceiling_height_m: )" +
                      std::to_string(2.8 + step_m) +
                      R"(
    corners: [[12, 0], [16, 0], [16, 5], [12, 5]]
ramps:
  - {from: [7, 2.5, 0.0], to: [12, 2.5, )" +
                      step + R"(], width_m: 2.4}
walls:
  - from: [4, 0]
    to: [4, 5]
    thickness_m: 0.15
    openings: [{position_m: 2.5, width_m: 1.0, height_m: 2.1}]
)";
  scenario.scanners = TiltedRig();
  for (ScenarioScanner& scanner : scenario.scanners) scanner.beams = 270;
  scenario.path = R"(path:
  way_points:
    - [1.5, 1.5, 0.0]
    - [2.5, 2.5, 0.0]
    - [7.0, 2.5, 0.0]
    - [12.0, 2.5, )" +
                  step + R"(]
    - [15.0, 2.0, )" +
                  step + R"(]
    - [15.0, 3.2, )" +
                  step + R"(]
  corner_radius_m: 0.4
  body_height_m: 1.4
speed_m_s: 0.9
)";
  return scenario;
}

class SplitLevelTest : public MappingTest, public ::testing::WithParamInterface<double> {};

TEST_P(SplitLevelTest, FloorsThatMeetAreOneStoreyWithAllItsRooms) {
  WriteRecording(Simulate(SplitLevel(GetParam())));
  MapJob job = Job();
  job.floor_plan = true;
  RunMapJob(job, [](double) {});
  const Json json = Json::parse(ReadBytes(Path("result/rooms.json")));
  ASSERT_EQ(json.at("storeys").size(), 1u);
  const Json& storey = json["storeys"][0];
  ASSERT_EQ(storey.at("rooms").size(), 2u);
  const double true_m2[] = {3.925 * 5.0, 2.925 * 5.0 + 5.0 * 2.4 + 4.0 * 5.0};
  for (size_t i = 0; i < 2; ++i) {
    const Json& room = storey["rooms"][i];
    EXPECT_NEAR(room.at("area_m2").get<double>(), true_m2[i], 0.005 * true_m2[i]);
  }
  ASSERT_EQ(storey.at("doors").size(), 1u);
  EXPECT_NEAR(storey["doors"][0].at("width_m").get<double>(), 1.0, 0.06);
}

INSTANTIATE_TEST_SUITE_P(Steps, SplitLevelTest, ::testing::Values(-0.6, 0.4, 1.2));

TEST_F(FloorPlanEndToEndTest, PlansOfStoreysThatAreNoMoreGo) {
  WriteRecording(Simulate(TwoRooms()));
  Map();
  WriteBytes(Path("result/floor_plan_2.svg"), "of before");
  WriteBytes(Path("result/floor_plan_notes.svg"), "mine");
  RunPlanJob(Path("result"), Path("rig.yaml"), Path("result"));
  EXPECT_FALSE(std::filesystem::exists(Path("result/floor_plan_2.svg")));
  EXPECT_TRUE(std::filesystem::exists(Path("result/floor_plan_notes.svg")));
}

}  // namespace
}  // namespace plumbline
