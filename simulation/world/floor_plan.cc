#include "simulation/world/floor_plan.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/angles.h"
#include "core/util/error.h"
#include "core/util/yaml_node.h"

namespace plumbline {
namespace {

constexpr double kMaxCoordinate = 10000.0;  // m; larger ones are millimetres by mistake
constexpr double kMaxHeight = 1000.0;       // m
constexpr double kMinRoomHeight = 0.1;      // m

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

// The polygon of a node's corners, all of whose keys have been read.
Polygon2 ReadPolygon(const YamlNode& node, std::vector<PlanCircle>* circles) {
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
  return polygon;
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

Eigen::Vector3d ReadPlace(const YamlNode& node) {
  const std::vector<double> xyz = node.AsDoubles(3, -kMaxCoordinate, kMaxCoordinate);
  return {xyz[0], xyz[1], xyz[2]};
}

void ReadOutlines(const YamlNode& list, FloorPlan* plan) {
  for (const YamlNode& node : list.Elements()) {
    Hall hall;
    hall.floor_height = plan->floor_height;
    hall.ceiling_height = plan->ceiling_height;
    node.Optional("floor_height_m", &hall.floor_height, -kMaxHeight, kMaxHeight);
    node.Optional("ceiling_height_m", &hall.ceiling_height, -kMaxHeight, kMaxHeight);
    if (hall.ceiling_height - hall.floor_height < kMinRoomHeight) {
      node.Fail("the ceiling must be above the floor");
    }
    const bool is_hall = node.Has("floor_height_m") || node.Has("ceiling_height_m");
    hall.corners = ReadPolygon(node, &plan->circles);
    if (is_hall) {
      plan->halls.push_back(std::move(hall));
    } else {
      plan->outlines.push_back(std::move(hall.corners));
    }
  }
  if (plan->outlines.empty() && plan->halls.empty()) list.Fail("the building has no outline");
}

// height: of the storey, m.
Ramp ReadRamp(const YamlNode& node, double height, std::vector<PlanCircle>* circles) {
  Ramp ramp;
  const Eigen::Vector3d from = ReadPlace(node["from"]);
  const Eigen::Vector3d to = ReadPlace(node["to"]);
  const double length = (to - from).head<2>().norm();
  if (length < 0.01) node.Fail("the ramp is shorter than 0.01 m");
  if (std::abs(to.z() - from.z()) > length) node.Fail("the ramp is steeper than 45 degrees");
  const bool has_corners = node.Has("corners");
  if (has_corners == node.Has("width_m")) node.Fail("a ramp has either a width or corners");
  ramp.floor = HeightPlane::Rising(from, to);
  ramp.ceiling = ramp.floor.RaisedBy(height);
  if (node.Has("ceiling_height_m")) {
    const double ceiling = node["ceiling_height_m"].AsDouble(-kMaxHeight, kMaxHeight);
    if (ceiling - std::max(from.z(), to.z()) < kMinRoomHeight) {
      node.Fail("the ceiling must be above the floor");
    }
    ramp.ceiling = HeightPlane::Level(ceiling);
  }
  if (has_corners) {
    ramp.corners = ReadPolygon(node, circles);
  } else {
    const double width_m = node["width_m"].AsDouble(0.01, kMaxCoordinate);
    ramp.corners = RectangleAlong(from.head<2>(), to.head<2>(), width_m, 0.0, length);
    node.RejectUnreadKeys();
  }
  return ramp;
}

Stairs ReadStairs(const YamlNode& node) {
  Stairs stairs;
  stairs.location = node.Location();
  stairs.from = ReadPlace(node["from"]);
  stairs.to = ReadPlace(node["to"]);
  stairs.width_m = node["width_m"].AsDouble(0.01, kMaxCoordinate);
  stairs.num_steps = node["steps"].AsInt(1, 1000);
  node.Optional("thickness_m", &stairs.thickness_m, 0.01, 10.0);
  node.RejectUnreadKeys();
  const double length = (stairs.to - stairs.from).head<2>().norm();
  if (length < 0.01 * stairs.num_steps) node.Fail("the treads are shorter than 0.01 m");
  if (stairs.to.z() - stairs.from.z() < 0.01 * stairs.num_steps) {
    node.Fail("the stairs must rise, by 0.01 m a step or more");
  }
  return stairs;
}

// A plane that rises to the left of its eave, or two that fall to both sides of their ridge.
Roof ReadRoof(const YamlNode& node) {
  Roof roof;
  roof.location = node.Location();
  const bool is_ridge = node.Has("ridge");
  if (is_ridge == node.Has("eave")) node.Fail("a roof's plane has either an eave or a ridge");
  const std::vector<YamlNode> ends = node[is_ridge ? "ridge" : "eave"].Elements();
  if (ends.size() != 2) node.Fail("an eave or a ridge has two ends");
  const Eigen::Vector2d from = ReadPoint(ends[0]);
  const Eigen::Vector2d along = ReadPoint(ends[1]) - from;
  if (along.norm() < 0.01) node.Fail("the ends of an eave or a ridge must differ");
  const double height = node["height_m"].AsDouble(-kMaxHeight, kMaxHeight);
  const double slope = std::tan(node["slope_deg"].AsDouble(0.0, 80.0) * kRadiansPerDegree);
  node.RejectUnreadKeys();
  const Eigen::Vector2d rise = slope * Eigen::Vector2d(-along.y(), along.x()).normalized();
  if (is_ridge) roof.planes.push_back({height + rise.dot(from), -rise});
  roof.planes.push_back({height - rise.dot(from), rise});
  return roof;
}

// Where a storey has rooms, seen from above, and errors for what lies elsewhere: it would be
// left out without a word.
class RoomsOfStorey {
 public:
  explicit RoomsOfStorey(const FloorPlan& plan) : rooms_(plan.outlines) {
    for (const Hall& hall : plan.halls) rooms_.push_back(hall.corners);
    num_outlines_ = rooms_.size();
    for (const Ramp& ramp : plan.ramps) rooms_.push_back(ramp.corners);
  }

  void CheckStandsIn(const YamlNode& node,
                     const std::string& what,
                     const Polygon2& footprint) const {
    const auto contains_any = [](const Polygon2& polygon, const Polygon2& points) {
      return std::any_of(points.begin(), points.end(), [&](const Eigen::Vector2d& point) {
        return Contains(polygon, point);
      });
    };
    // Most have a corner in a room, and cost no exact arithmetic.
    for (const Polygon2& room : rooms_) {
      if (contains_any(room, footprint)) return;
    }
    for (const Polygon2& room : rooms_) {
      PlanarRegion rest;
      rest.Join(footprint);
      rest.Subtract(room);
      PlanarRegion shared;
      shared.Join(footprint);
      shared.Subtract(rest);
      if (!shared.Polygons().empty()) return;
    }
    node.Fail(what + " stands in no room");
  }

  // A ramp is a room; it has to lead to another one.
  void CheckTouchesRoom(const YamlNode& node, size_t ramp_index) const {
    constexpr double kStep = 0.05;   // m, along the ramp's edges
    constexpr double kReach = 0.01;  // m, to both sides of them
    const size_t own = num_outlines_ + ramp_index;
    const Polygon2& corners = rooms_[own];
    for (size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d edge = corners[(i + 1) % corners.size()] - corners[i];
      const Eigen::Vector2d aside = kReach * Eigen::Vector2d(-edge.y(), edge.x()).normalized();
      const int num_steps = static_cast<int>(std::ceil(edge.norm() / kStep));
      for (int step = 0; step < num_steps; ++step) {
        const Eigen::Vector2d place = corners[i] + (step + 0.5) / num_steps * edge;
        for (size_t room = 0; room < rooms_.size(); ++room) {
          if (room == own) continue;
          if (Contains(rooms_[room], place + aside)) return;
          if (Contains(rooms_[room], place - aside)) return;
        }
      }
    }
    node.Fail("the ramp touches no room");
  }

 private:
  std::vector<Polygon2> rooms_;  // outlines, halls, then ramps
  size_t num_outlines_ = 0;      // and halls
};

Polygon2 FootprintOf(const Furniture& piece) {
  const Eigen::Vector2d half =
      piece.size.x() / 2 * Eigen::Vector2d(std::cos(piece.yaw_rad), std::sin(piece.yaw_rad));
  return RectangleAlong(
      piece.position - half, piece.position + half, piece.size.y(), 0.0, piece.size.x());
}

FloorPlan ReadStorey(const YamlNode& node) {
  FloorPlan plan;
  plan.location = node.Location();
  plan.floor_height = node["floor_height_m"].AsDouble(-kMaxHeight, kMaxHeight);
  plan.ceiling_height = node["ceiling_height_m"].AsDouble(-kMaxHeight, kMaxHeight);
  const double height = plan.ceiling_height - plan.floor_height;
  if (height < kMinRoomHeight) {
    node["ceiling_height_m"].Fail("the ceiling must be above the floor");
  }
  const auto for_each = [&node](const std::string& key, auto read) {
    if (!node.Has(key)) return;
    for (const YamlNode& element : node[key].Elements()) read(element);
  };
  ReadOutlines(node["outlines"], &plan);
  for_each("ramps", [&](const YamlNode& n) {
    plan.ramps.push_back(ReadRamp(n, height, &plan.circles));
  });
  for_each("stairs", [&](const YamlNode& n) { plan.stairs.push_back(ReadStairs(n)); });
  for_each("roof", [&](const YamlNode& n) { plan.roofs.push_back(ReadRoof(n)); });
  for_each("floor_openings", [&](const YamlNode& n) {
    plan.floor_openings.push_back({n.Location(), ReadPolygon(n, &plan.circles)});
  });
  const RoomsOfStorey rooms(plan);
  size_t ramp_index = 0;
  for_each("ramps", [&](const YamlNode& n) { rooms.CheckTouchesRoom(n, ramp_index++); });
  for_each("solids", [&](const YamlNode& n) {
    plan.solids.push_back(ReadPolygon(n, &plan.circles));
    rooms.CheckStandsIn(n, "the solid", plan.solids.back());
  });
  for_each("walls", [&](const YamlNode& n) {
    const Wall wall = ReadWall(n, height);
    rooms.CheckStandsIn(n, "the wall", wall.Footprint(0.0, (wall.to - wall.from).norm()));
    plan.walls.push_back(wall);
  });
  for_each("furniture", [&](const YamlNode& n) {
    plan.furniture.push_back(ReadFurniture(n));
    rooms.CheckStandsIn(n, "the furniture", FootprintOf(plan.furniture.back()));
  });
  node.RejectUnreadKeys();
  return plan;
}

}  // namespace

Polygon2 RectangleAlong(const Eigen::Vector2d& from,
                        const Eigen::Vector2d& to,
                        double width_m,
                        double begin_m,
                        double end_m) {
  const Eigen::Vector2d direction = (to - from).normalized();
  const Eigen::Vector2d half(-direction.y() * width_m / 2, direction.x() * width_m / 2);
  const Eigen::Vector2d begin = from + begin_m * direction;
  const Eigen::Vector2d end = from + end_m * direction;
  return {begin - half, end - half, end + half, begin + half};
}

Polygon2 Wall::Footprint(double begin_m, double end_m) const {
  return RectangleAlong(from, to, thickness_m, begin_m, end_m);
}

std::vector<Polygon2> Wall::FootprintsBeside(std::vector<Opening> open) const {
  std::sort(open.begin(), open.end(), [](const Opening& a, const Opening& b) {
    return a.position_m < b.position_m;
  });
  std::vector<Polygon2> footprints;
  double begin = 0.0;
  const double length = (to - from).norm();
  for (const Opening& opening : open) {
    const double end = opening.position_m - opening.width_m / 2;
    if (end > begin) footprints.push_back(Footprint(begin, end));
    begin = opening.position_m + opening.width_m / 2;
  }
  if (length > begin) footprints.push_back(Footprint(begin, length));
  return footprints;
}

bool FloorPlan::IsLevel() const {
  return halls.empty() && ramps.empty() && roofs.empty() && stairs.empty() &&
         floor_openings.empty();
}

std::vector<FloorPlan> ReadFloorPlans(const std::string& path) {
  const YamlNode root = YamlNode::ReadFile(path);
  std::vector<FloorPlan> storeys;
  if (root.Has("storeys")) {
    for (const YamlNode& node : root["storeys"].Elements()) {
      storeys.push_back(ReadStorey(node));
      if (storeys.size() == 1) continue;
      if (storeys.back().floor_height <= storeys[storeys.size() - 2].floor_height) {
        node["floor_height_m"].Fail("storeys stand in their order from the lowest up");
      }
    }
    root.RejectUnreadKeys();
    if (storeys.empty()) root["storeys"].Fail("the building has no storey");
  } else {
    storeys.push_back(ReadStorey(root));
  }
  if (!storeys.front().floor_openings.empty()) {
    throw Error(storeys.front().floor_openings.front().location +
                ": there is no storey below the lowest floor");
  }
  return storeys;
}

}  // namespace plumbline
