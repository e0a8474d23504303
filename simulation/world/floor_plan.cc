#include "simulation/world/floor_plan.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/angles.h"
#include "core/util/yaml_node.h"

namespace plumbline {
namespace {

constexpr double kMaxCoordinate = 10000.0;  // m; larger ones are millimetres by mistake

Eigen::Vector2d ReadPoint(const YamlNode& node) {
  const std::vector<double> xy = node.AsDoubles(2, -kMaxCoordinate, kMaxCoordinate);
  return {xy[0], xy[1]};
}

// Adds the corners of an arc that begins at the polygon's last corner: a chord of each stays
// within kSagitta of it. The circle is taken down.
void ReadArc(const YamlNode& node, Polygon2* polygon, std::vector<PlanCircle>* circles) {
  constexpr double kSagitta = 1e-4;      // m
  constexpr double kMinBend = 1e-3;      // of the three points
  constexpr double kMaxRadius = 1000.0;  // m
  if (polygon->empty()) node.Fail("the first corner can not be an arc");
  const Eigen::Vector2d from = polygon->back();
  const Eigen::Vector2d by = ReadPoint(node["through"]) - from;
  const Eigen::Vector2d to = ReadPoint(node["to"]) - from;
  node.RejectUnreadKeys();
  const double area2 = by.x() * to.y() - by.y() * to.x();
  if (!(std::abs(area2) > kMinBend * by.norm() * to.norm())) {
    node.Fail("the arc's three points lie on a line");
  }
  PlanCircle circle;
  const Eigen::Vector2d to_centre(by.squaredNorm() * to.y() - to.squaredNorm() * by.y(),
                                  to.squaredNorm() * by.x() - by.squaredNorm() * to.x());
  circle.centre = from + to_centre / (2.0 * area2);
  circle.radius_m = (from - circle.centre).norm();
  if (circle.radius_m > kMaxRadius) node.Fail("the arc's radius is more than 1000 m");
  const auto angle_of = [&](const Eigen::Vector2d& p) {
    return std::atan2(p.y() - circle.centre.y(), p.x() - circle.centre.x());
  };
  // Counter-clockwise where the three points turn left.
  const double side = area2 > 0.0 ? 1.0 : -1.0;
  const double begin = angle_of(from);
  double turn = side * (angle_of(from + to) - begin);
  while (turn <= 0.0) turn += 2.0 * M_PI;
  const double step = 2.0 * std::acos(1.0 - kSagitta / circle.radius_m);
  const int num_steps = static_cast<int>(std::ceil(turn / step));
  for (int i = 1; i < num_steps; ++i) {
    const double angle = begin + side * turn * i / num_steps;
    polygon->push_back(circle.centre +
                       circle.radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  if ((from + to - polygon->front()).norm() > 1e-9) polygon->push_back(from + to);
  circles->push_back(circle);
}

std::vector<Polygon2> ReadPolygons(const YamlNode& list, std::vector<PlanCircle>* circles) {
  std::vector<Polygon2> polygons;
  for (const YamlNode& node : list.Elements()) {
    Polygon2 polygon;
    for (const YamlNode& corner : node["corners"].Elements()) {
      if (corner.IsMapping()) {
        ReadArc(corner, &polygon, circles);
      } else {
        polygon.push_back(ReadPoint(corner));
      }
    }
    node.RejectUnreadKeys();
    if (polygon.size() < 3) node.Fail("a polygon needs at least three corners");
    if (!IsSimplePolygon(polygon)) node.Fail("the polygon crosses or touches itself");
    polygons.push_back(std::move(polygon));
  }
  return polygons;
}

std::vector<Opening> ReadOpenings(const YamlNode& list, double wall_length, double height) {
  std::vector<Opening> openings;
  for (const YamlNode& node : list.Elements()) {
    Opening opening;
    opening.position_m = node["position_m"].AsDouble(0.0, kMaxCoordinate);
    opening.width_m = node["width_m"].AsDouble(0.01, kMaxCoordinate);
    opening.height_m = node["height_m"].AsDouble(0.01, kMaxCoordinate);
    node.RejectUnreadKeys();
    const double half = opening.width_m / 2;
    if (opening.position_m - half < 0.0 || opening.position_m + half > wall_length) {
      node.Fail("the opening reaches beyond the end of its wall");
    }
    if (opening.height_m > height) node.Fail("the opening is higher than the ceiling");
    for (const Opening& other : openings) {
      if (std::abs(other.position_m - opening.position_m) < half + other.width_m / 2) {
        node.Fail("the opening overlaps another one of its wall");
      }
    }
    openings.push_back(opening);
  }
  return openings;
}

Wall ReadWall(const YamlNode& node, double height) {
  Wall wall;
  wall.from = ReadPoint(node["from"]);
  wall.to = ReadPoint(node["to"]);
  wall.thickness_m = node["thickness_m"].AsDouble(0.01, 10.0);
  const double length = (wall.to - wall.from).norm();
  if (length < 0.01) node.Fail("the wall is shorter than 0.01 m");
  if (node.Has("openings")) {
    wall.openings = ReadOpenings(node["openings"], length, height);
  }
  node.RejectUnreadKeys();
  return wall;
}

Furniture ReadFurniture(const YamlNode& node) {
  Furniture piece;
  const std::vector<std::string> kinds = {"box", "table", "shelf"};
  piece.kind = static_cast<Furniture::Kind>(node["kind"].AsChoice(kinds));
  piece.position = ReadPoint(node["position"]);
  const std::vector<double> size = node["size_m"].AsDoubles(3, 0.01, 1000.0);
  piece.size = {size[0], size[1], size[2]};
  double yaw_deg = 0.0;
  node.Optional("yaw_deg", &yaw_deg, -360.0, 360.0);
  piece.yaw_rad = yaw_deg * kRadiansPerDegree;
  node.Optional("bottom_m", &piece.bottom_m, 0.0, 100.0);
  node.Optional("glass", &piece.glass);
  node.RejectUnreadKeys();
  return piece;
}

}  // namespace

Polygon2 Wall::Footprint(double begin_m, double end_m) const {
  const Eigen::Vector2d direction = (to - from).normalized();
  const Eigen::Vector2d half(-direction.y() * thickness_m / 2,
                             direction.x() * thickness_m / 2);
  const Eigen::Vector2d begin = from + begin_m * direction;
  const Eigen::Vector2d end = from + end_m * direction;
  return {begin - half, end - half, end + half, begin + half};
}

FloorPlan ReadFloorPlan(const std::string& path) {
  const YamlNode root = YamlNode::ReadFile(path);
  FloorPlan plan;
  plan.location = root.Location();
  plan.floor_height = root["floor_height_m"].AsDouble(-1000.0, 1000.0);
  plan.ceiling_height = root["ceiling_height_m"].AsDouble(-1000.0, 1000.0);
  const double height = plan.ceiling_height - plan.floor_height;
  if (height < 0.1) root["ceiling_height_m"].Fail("the ceiling must be above the floor");
  plan.outlines = ReadPolygons(root["outlines"], &plan.circles);
  if (plan.outlines.empty()) root["outlines"].Fail("the building has no outline");
  if (root.Has("solids")) plan.solids = ReadPolygons(root["solids"], &plan.circles);
  if (root.Has("walls")) {
    for (const YamlNode& node : root["walls"].Elements()) {
      plan.walls.push_back(ReadWall(node, height));
    }
  }
  if (root.Has("furniture")) {
    for (const YamlNode& node : root["furniture"].Elements()) {
      plan.furniture.push_back(ReadFurniture(node));
    }
  }
  root.RejectUnreadKeys();
  return plan;
}

}  // namespace plumbline
