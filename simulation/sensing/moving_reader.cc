#include "simulation/sensing/moving_reader.h"

#include "core/geometry/angles.h"

namespace plumbline {
namespace {

constexpr double kMaxLength = 1e5;  // m

// [x, y, z], or [x, y] on the floor.
Eigen::Vector3d ReadPlace(const YamlNode& node, double floor_height) {
  const std::vector<double> xyz = node.AsDoubles(-1, -kMaxLength, kMaxLength);
  if (xyz.size() != 2 && xyz.size() != 3) node.Fail("a place is [x, y] or [x, y, z]");
  return {xyz[0], xyz[1], xyz.size() == 3 ? xyz[2] : floor_height};
}

Person ReadPerson(const YamlNode& node, double floor_height) {
  Person person;
  if (node.Has("walks") + node.Has("follows_m") + node.Has("circles_m") != 1) {
    node.Fail("a person has one of walks, follows_m and circles_m");
  }
  if (node.Has("walks")) {
    for (const YamlNode& point : node["walks"].Elements()) {
      person.way_points.push_back(ReadPlace(point, floor_height));
    }
    if (person.way_points.size() < 2 || person.way_points[0] == person.way_points[1]) {
      node["walks"].Fail("a person walks between two places or more");
    }
  }
  node.Optional("follows_m", &person.follows_m, 0.5, 100.0);
  node.Optional("circles_m", &person.circles_m, 0.5, 100.0);
  node.Optional("speed_m_s", &person.speed_m_s, 0.01, 10.0);
  node.Optional("radius_m", &person.radius_m, 0.01, 2.0);
  node.Optional("height_m", &person.height_m, 0.1, 3.0);
  node.RejectUnreadKeys();
  return person;
}

Door ReadDoor(const YamlNode& node, double floor_height) {
  Door door;
  door.hinge = ReadPlace(node["hinge"], floor_height);
  node.Optional("width_m", &door.width_m, 0.1, 10.0);
  node.Optional("height_m", &door.height_m, 0.1, 10.0);
  door.shut_rad = node["shut_deg"].AsDouble(-360.0, 360.0) * kRadiansPerDegree;
  door.open_rad = node["open_deg"].AsDouble(-360.0, 360.0) * kRadiansPerDegree;
  node.Optional("period_s", &door.period_s, 0.5, 3600.0);
  node.RejectUnreadKeys();
  return door;
}

}  // namespace

MovingOptions ReadMoving(const YamlNode& node, double floor_height) {
  MovingOptions moving;
  if (node.Has("people")) {
    for (const YamlNode& person : node["people"].Elements()) {
      moving.people.push_back(ReadPerson(person, floor_height));
    }
  }
  if (node.Has("doors")) {
    for (const YamlNode& door : node["doors"].Elements()) {
      moving.doors.push_back(ReadDoor(door, floor_height));
    }
  }
  node.RejectUnreadKeys();
  return moving;
}

}  // namespace plumbline
