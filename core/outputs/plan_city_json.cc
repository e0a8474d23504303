#include "core/outputs/plan_city_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

namespace plumbline {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kUnitM = 1e-4;  // of the file's whole-numbered coordinates

// CityModel gathers the vertices that all objects share.
class CityModel {
 public:
  int Vertex(const Eigen::Vector2d& p, double z) {
    const std::array<int64_t, 3> key = {Units(p.x()), Units(p.y()), Units(z)};
    const auto [at, is_new] = index_.try_emplace(key, static_cast<int>(vertices_.size()));
    if (is_new) vertices_.push_back(key);
    return at->second;
  }

  Json VerticesJson() const {
    Json json = Json::array();
    for (const auto& vertex : vertices_) json.push_back({vertex[0], vertex[1], vertex[2]});
    return json;
  }

  // [min x, y, z, max x, y, z], m.
  Json ExtentJson() const {
    std::array<int64_t, 3> low = vertices_.front();
    std::array<int64_t, 3> high = low;
    for (const auto& vertex : vertices_) {
      for (size_t i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], vertex[i]);
        high[i] = std::max(high[i], vertex[i]);
      }
    }
    Json json = Json::array();
    for (const int64_t value : low) json.push_back(static_cast<double>(value) * kUnitM);
    for (const int64_t value : high) json.push_back(static_cast<double>(value) * kUnitM);
    return json;
  }

 private:
  static int64_t Units(double metres) { return std::llround(metres / kUnitM); }

  std::map<std::array<int64_t, 3>, int> index_;
  std::vector<std::array<int64_t, 3>> vertices_;
};

Json Ring(const RoomLoop& loop, double z, bool reversed, CityModel* model) {
  std::vector<int> ring;
  for (const RoomEdge& edge : loop) {
    const int vertex = model->Vertex(edge.from, z);
    if (ring.empty() || (ring.back() != vertex && ring.front() != vertex))
      ring.push_back(vertex);
  }
  if (reversed) std::reverse(ring.begin(), ring.end());
  return ring;
}

Json LevelSurface(const Room& room, double z, bool looks_down, CityModel* model) {
  Json rings = Json::array();
  for (const RoomLoop& loop : room.loops) rings.push_back(Ring(loop, z, looks_down, model));
  return rings;
}

// The walls' faces, seen from outside of the room, with the surfaces of the map they lie on.
void AddWalls(const Room& room,
              double floor_m,
              double ceiling_m,
              CityModel* model,
              Json* surfaces,
              Json* semantics,
              Json* values) {
  for (const RoomLoop& loop : room.loops) {
    for (size_t i = 0; i < loop.size(); ++i) {
      const Eigen::Vector2d& a = loop[i].from;
      const Eigen::Vector2d& b = loop[(i + 1) % loop.size()].from;
      const int corners[] = {model->Vertex(a, floor_m),
                             model->Vertex(b, floor_m),
                             model->Vertex(b, ceiling_m),
                             model->Vertex(a, ceiling_m)};
      if (corners[0] == corners[1]) continue;
      surfaces->push_back(Json::array({Json(corners)}));
      values->push_back(semantics->size());
      Json semantic = {{"type", "InteriorWallSurface"}};
      if (loop[i].plane_id >= 0) semantic["plane"] = loop[i].plane_id;
      semantics->push_back(semantic);
    }
  }
}

Json SolidJson(const Room& room, CityModel* model) {
  Json surfaces = Json::array();
  Json semantics = {{{"type", "FloorSurface"}}, {{"type", "CeilingSurface"}}};
  Json values = {0, 1};
  surfaces.push_back(LevelSurface(room, *room.floor_m, true, model));
  surfaces.push_back(LevelSurface(room, *room.ceiling_m, false, model));
  AddWalls(room, *room.floor_m, *room.ceiling_m, model, &surfaces, &semantics, &values);
  return {{"type", "Solid"},
          {"lod", "2"},
          {"boundaries", Json::array({surfaces})},
          {"semantics", {{"surfaces", semantics}, {"values", Json::array({values})}}}};
}

Json FloorJson(const Room& room, double floor_m, CityModel* model) {
  const Json semantics = Json::array({{{"type", "FloorSurface"}}});
  return {{"type", "MultiSurface"},
          {"lod", "0"},
          {"boundaries", Json::array({LevelSurface(room, floor_m, false, model)})},
          {"semantics", {{"surfaces", semantics}, {"values", {0}}}}};
}

Json RoomJson(const Room& room, double floor_m, const std::string& storey, CityModel* model) {
  Json attributes = {{"number", room.number},
                     {"area_m2", std::round(room.area_m2 * 1e4) / 1e4},
                     {"sigma_area_m2", std::round(room.area_stddev_m2 * 1e4) / 1e4},
                     {"entered", room.entered}};
  const Json geometry = room.floor_m && room.ceiling_m
                            ? SolidJson(room, model)
                            : FloorJson(room, room.floor_m.value_or(floor_m), model);
  return {{"type", "BuildingRoom"},
          {"attributes", attributes},
          {"parents", {storey}},
          {"geometry", Json::array({geometry})}};
}

}  // namespace

std::string FormatCityJson(const FloorPlans& plan) {
  CityModel model;
  Json objects = Json::object();
  objects["building"] = {{"type", "Building"},
                         {"attributes",
                          {{"verdict", plan.origin.verdict},
                           {"recording", plan.origin.recording},
                           {"version", plan.origin.version}}},
                         {"children", Json::array()}};
  for (size_t i = 0; i < plan.storeys.size(); ++i) {
    const StoreyPlan& storey = plan.storeys[i];
    const std::string storey_name = "storey_" + std::to_string(i + 1);
    objects["building"]["children"].push_back(storey_name);
    objects[storey_name] = {
        {"type", "BuildingStorey"}, {"parents", {"building"}}, {"children", Json::array()}};
    for (const Room& room : storey.rooms) {
      const std::string name = storey_name + "_room_" + std::to_string(room.number);
      objects[storey_name]["children"].push_back(name);
      objects[name] = RoomJson(room, storey.level.floor_m, storey_name, &model);
    }
  }
  Json metadata = {{"geographicalExtent", model.ExtentJson()}};
  if (!plan.origin.date.empty()) metadata["referenceDate"] = plan.origin.date;
  const Json json = {
      {"type", "CityJSON"},
      {"version", "2.0"},
      {"transform", {{"scale", {kUnitM, kUnitM, kUnitM}}, {"translate", {0.0, 0.0, 0.0}}}},
      {"metadata", metadata},
      {"CityObjects", objects},
      {"vertices", model.VerticesJson()}};
  // The recording's name need not be UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace plumbline
