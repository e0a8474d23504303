#include "core/outputs/plan_city_json.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "test/core/outputs/plan_of_rooms.h"

namespace plumbline {
namespace {

using Json = nlohmann::json;

// A file as a reader of CityJSON takes it.
struct CityModel {
  explicit CityModel(const FloorPlans& plan) : json(Json::parse(FormatCityJson(plan))) {
    const Json& transform = json["transform"];
    for (const Json& vertex : json["vertices"]) {
      Eigen::Vector3d& point = vertices.emplace_back();
      for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<size_t>(i);
        point[i] = vertex[axis].get<double>() * transform["scale"][axis].get<double>() +
                   transform["translate"][axis].get<double>();
      }
    }
  }
  const Json& Geometry(const std::string& object) const {
    return json["CityObjects"][object]["geometry"][0];
  }
  // Twice the area of a ring, along the normal from which it goes round counterclockwise.
  Eigen::Vector3d DoubleArea(const Json& ring) const {
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < ring.size(); ++i) {
      area += vertices[ring[i]].cross(vertices[ring[(i + 1) % ring.size()]]);
    }
    return area;
  }

  Json json;
  std::vector<Eigen::Vector3d> vertices;
};

TEST(FormatCityJsonTest, ObjectsAreABuildingItsStoreysAndRooms) {
  const CityModel model(PlanOfRooms());
  EXPECT_EQ(model.json["type"], "CityJSON");
  EXPECT_EQ(model.json["version"], "2.0");
  EXPECT_EQ(model.json["metadata"]["referenceDate"], "2026-11-27");
  const Json& objects = model.json["CityObjects"];
  EXPECT_EQ(objects.size(), 4u);
  EXPECT_EQ(objects["building"]["children"], Json::parse("[\"storey_1\"]"));
  EXPECT_EQ(objects["storey_1"]["parents"], Json::parse("[\"building\"]"));
  EXPECT_EQ(objects["storey_1"]["children"],
            Json::parse("[\"storey_1_room_1\",\"storey_1_room_2\"]"));
  EXPECT_EQ(objects["storey_1_room_1"]["type"], "BuildingRoom");
  EXPECT_EQ(objects["storey_1_room_1"]["attributes"]["area_m2"], 11.0);
}

TEST(FormatCityJsonTest, CoordinatesAreMetresOfTheModelFrame) {
  const CityModel model(PlanOfRooms());
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : model.vertices) box.extend(vertex);
  EXPECT_LT((box.min() - Eigen::Vector3d(0.0, 0.0, -1.2)).norm(), 1e-9);
  EXPECT_LT((box.max() - Eigen::Vector3d(6.0, 3.0, 1.3)).norm(), 1e-9);
  const Json& extent = model.json["metadata"]["geographicalExtent"];
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(extent[i].get<double>(), box.min()[static_cast<Eigen::Index>(i)], 1e-9);
    EXPECT_NEAR(extent[i + 3].get<double>(), box.max()[static_cast<Eigen::Index>(i)], 1e-9);
  }
}

// Every edge of a closed surface is walked once either way, and with the faces seen from
// outside the volume is positive: 4 m x 3 m x 2.5 m without the pillar.
TEST(FormatCityJsonTest, RoomIsAClosedSolid) {
  const CityModel model(PlanOfRooms());
  const Json& geometry = model.Geometry("storey_1_room_1");
  ASSERT_EQ(geometry["type"], "Solid");
  std::map<std::pair<int, int>, int> edges;
  double volume = 0.0;
  const Json& shell = geometry["boundaries"][0];
  ASSERT_EQ(shell.size(), 2u + 4u + 4u);
  for (const Json& surface : shell) {
    for (const Json& ring : surface) {
      for (size_t i = 0; i < ring.size(); ++i) {
        ++edges[{ring[i].get<int>(), ring[(i + 1) % ring.size()].get<int>()}];
      }
      volume += model.vertices[ring[0]].dot(model.DoubleArea(ring)) / 6.0;
    }
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
  EXPECT_NEAR(volume, 11.0 * 2.5, 1e-9);
}

TEST(FormatCityJsonTest, SurfacesSayWhatTheyAre) {
  const CityModel model(PlanOfRooms());
  const Json& semantics = model.Geometry("storey_1_room_1")["semantics"];
  const Json& values = semantics["values"][0];
  ASSERT_EQ(values.size(), 10u);
  EXPECT_EQ(semantics["surfaces"][values[0].get<size_t>()]["type"], "FloorSurface");
  EXPECT_EQ(semantics["surfaces"][values[1].get<size_t>()]["type"], "CeilingSurface");
  for (size_t i = 2; i < 10; ++i) {
    const Json& surface = semantics["surfaces"][values[i].get<size_t>()];
    EXPECT_EQ(surface["type"], "InteriorWallSurface");
    // The pillar lies on no surface of the map.
    EXPECT_EQ(surface.value("plane", -1), i < 6 ? static_cast<int>(i) + 8 : -1);
  }
}

TEST(FormatCityJsonTest, RoomWithoutCeilingIsItsFloor) {
  const CityModel model(PlanOfRooms());
  const Json& geometry = model.Geometry("storey_1_room_2");
  EXPECT_EQ(geometry["type"], "MultiSurface");
  ASSERT_EQ(geometry["boundaries"].size(), 1u);
  const Json& ring = geometry["boundaries"][0][0];
  ASSERT_EQ(ring.size(), 3u);
  for (const Json& vertex : ring) EXPECT_NEAR(model.vertices[vertex].z(), -1.2, 1e-9);
  EXPECT_GT(model.DoubleArea(ring).z(), 0.0);  // seen from above
}

TEST(FormatCityJsonTest, CornersAreSharedAndFallTogetherBelowTheUnit) {
  FloorPlans plan = PlanOfRooms();
  plan.storeys[0].rooms[0].loops = {
      LoopOf({{0.0, 0.0}, {4.0, 0.0}, {4.0, 3.0}, {4.00001, 3.0}, {0.0, 3.0}}, 10)};
  const CityModel model(plan);
  EXPECT_EQ(model.vertices.size(), 2u * 4u + 3u);
  EXPECT_EQ(model.Geometry("storey_1_room_1")["boundaries"][0].size(), 2u + 4u);
}

}  // namespace
}  // namespace plumbline
