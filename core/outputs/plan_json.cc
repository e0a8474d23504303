#include "core/outputs/plan_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

// To a tenth of a millimetre or a square centimetre: what is less is not known.
double Rounded(double value) {
  constexpr double kUnit = 1e4;
  return std::round(value * kUnit) / kUnit;
}

Json PointJson(const Eigen::Vector2d& p) { return {Rounded(p.x()), Rounded(p.y())}; }

Json OptionalJson(const std::optional<double>& value) {
  return value ? Json(Rounded(*value)) : Json(nullptr);
}

Json LoopJson(const RoomLoop& loop) {
  Json corners = Json::array();
  for (const RoomEdge& edge : loop) corners.push_back(PointJson(edge.from));
  return corners;
}

Json PlanesJson(const RoomLoop& loop) {
  Json planes = Json::array();
  for (const RoomEdge& edge : loop) planes.push_back(edge.plane_id);
  return planes;
}

Json DimensionJson(const Dimension& dimension) {
  return {{"from", PointJson(dimension.from)},
          {"to", PointJson(dimension.to)},
          {"planes", {dimension.plane_a, dimension.plane_b}},
          {"length_m", Rounded(dimension.length_m)},
          {"sigma_m", Rounded(dimension.stddev_m)}};
}

Json RoomJson(const Room& room) {
  Json json = {{"number", room.number},
               {"entered", room.entered},
               {"area_m2", Rounded(room.area_m2)},
               {"sigma_area_m2", Rounded(room.area_stddev_m2)},
               {"perimeter_m", Rounded(room.perimeter_m)},
               {"unseen_m", Rounded(room.unseen_m)},
               {"floor_m", OptionalJson(room.floor_m)},
               {"height_m", nullptr},
               {"sigma_height_m", OptionalJson(room.height_stddev_m)}};
  if (room.floor_m && room.ceiling_m)
    json["height_m"] = Rounded(*room.ceiling_m - *room.floor_m);
  json["outline"] = LoopJson(room.loops.front());
  json["outline_planes"] = PlanesJson(room.loops.front());
  json["holes"] = Json::array();
  for (size_t i = 1; i < room.loops.size(); ++i)
    json["holes"].push_back(LoopJson(room.loops[i]));
  json["floor_openings"] = Json::array();
  for (const RoomFloorOpening& opening : room.floor_openings) {
    json["floor_openings"].push_back({{"area_m2", Rounded(opening.area_m2)},
                                      {"sigma_area_m2", Rounded(opening.stddev_m2)},
                                      {"from", PointJson(opening.box.min())},
                                      {"to", PointJson(opening.box.max())}});
  }
  json["dimensions"] = Json::array();
  for (const Dimension& dimension : room.dimensions) {
    json["dimensions"].push_back(DimensionJson(dimension));
  }
  return json;
}

Json DoorJson(const PlanDoor& door) {
  Json rooms = Json::array();
  for (const int room : door.rooms) rooms.push_back(room == 0 ? Json(nullptr) : Json(room));
  return {{"from", PointJson(door.from)},
          {"to", PointJson(door.to)},
          {"plane", door.plane_id},
          {"rooms", rooms},
          {"width_m", Rounded(door.width_m)},
          {"sigma_width_m", Rounded(door.width_stddev_m)},
          {"depth_m", door.depth_m > 0.0 ? Json(Rounded(door.depth_m)) : Json(nullptr)}};
}

Json WallJson(const WallPiece& wall) {
  Json corners = Json::array();
  for (const Eigen::Vector2d& corner : wall.corners) corners.push_back(PointJson(corner));
  return {{"corners", corners},
          {"planes", {wall.plane_a, wall.plane_b}},
          {"thickness_m", Rounded(wall.thickness_m)},
          {"sigma_m", Rounded(wall.stddev_m)}};
}

Json OriginJson(const MapOrigin& origin) {
  const auto text = [](const std::string& value) {
    return value.empty() ? Json(nullptr) : Json(value);
  };
  return {{"verdict", text(origin.verdict)},
          {"recording", text(origin.recording)},
          {"version", text(origin.version)},
          {"date", text(origin.date)}};
}

}  // namespace

std::string FormatRooms(const FloorPlans& plan) {
  Json storeys = Json::array();
  for (size_t i = 0; i < plan.storeys.size(); ++i) {
    const StoreyPlan& storey = plan.storeys[i];
    Json json = {
        {"storey", i + 1},
        {"floor_m",
         storey.level.has_floor ? Json(Rounded(storey.level.floor_m)) : Json(nullptr)},
        {"rooms", Json::array()},
        {"doors", Json::array()},
        {"windows", Json::array()},
        {"walls", Json::array()}};
    for (const Room& room : storey.rooms) json["rooms"].push_back(RoomJson(room));
    for (const PlanDoor& door : storey.doors) {
      json["doors"].push_back(DoorJson(door));
    }
    for (const PlanWindow& window : storey.windows) {
      json["windows"].push_back({{"from", PointJson(window.from)},
                                 {"to", PointJson(window.to)},
                                 {"width_m", Rounded((window.to - window.from).norm())},
                                 {"sigma_width_m", Rounded(window.width_stddev_m)},
                                 {"reaches_floor", window.reaches_floor}});
    }
    for (const WallPiece& wall : storey.walls) json["walls"].push_back(WallJson(wall));
    storeys.push_back(std::move(json));
  }
  Json json = OriginJson(plan.origin);
  json["storeys"] = storeys;
  // The recording's name need not be UTF-8.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace plumbline
