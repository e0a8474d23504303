#include "simulation/world/building.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>

#include "core/util/error.h"
#include "simulation/world/furniture.h"
#include "simulation/world/mesh_building.h"

namespace plumbline {
namespace {

constexpr double kMinEdge = 1e-3;         // m; shorter ones are a mistake in the file
constexpr double kCoordinateStep = 1e-9;  // m; makes coordinates along a wall comparable

// Between two heights the free space is the same at every height.
struct Layer {
  double bottom = 0.0;
  double top = 0.0;
  PlanarRegion free_space;
};

PlanarRegion FreeSpace(const FloorPlan& plan, double height_above_floor) {
  PlanarRegion region;
  for (const Polygon2& outline : plan.outlines) region.Join(outline);
  for (const Polygon2& solid : plan.solids) region.Subtract(solid);
  for (const Wall& wall : plan.walls) {
    std::vector<Opening> open;
    for (const Opening& opening : wall.openings) {
      if (opening.height_m > height_above_floor) open.push_back(opening);
    }
    std::sort(open.begin(), open.end(), [](const Opening& a, const Opening& b) {
      return a.position_m < b.position_m;
    });
    double begin = 0.0;
    const double length = (wall.to - wall.from).norm();
    for (const Opening& opening : open) {
      const double end = opening.position_m - opening.width_m / 2;
      if (end > begin) region.Subtract(wall.Footprint(begin, end));
      begin = opening.position_m + opening.width_m / 2;
    }
    if (length > begin) region.Subtract(wall.Footprint(begin, length));
  }
  return region;
}

std::vector<Layer> MakeLayers(const FloorPlan& plan) {
  std::set<double> tops = {plan.ceiling_height};
  for (const Wall& wall : plan.walls) {
    for (const Opening& opening : wall.openings) {
      tops.insert(std::min(plan.floor_height + opening.height_m, plan.ceiling_height));
    }
  }
  std::vector<Layer> layers;
  double bottom = plan.floor_height;
  for (const double top : tops) {
    if (top - bottom < kSamePlane) continue;
    const double middle = (bottom + top) / 2 - plan.floor_height;
    layers.push_back({bottom, top, FreeSpace(plan, middle)});
    bottom = top;
  }
  return layers;
}

// Faces of one plane: a region in coordinates (u, v) along the plane.
struct PlaneOfFaces {
  Eigen::Vector3d normal;
  double distance = 0.0;
  Eigen::Vector3d u_axis;  // u_axis, v_axis, normal: right-handed
  Eigen::Vector3d v_axis;
  PlanarRegion region;

  Eigen::Vector3d ToWorld(const Eigen::Vector2d& uv) const {
    return uv.x() * u_axis + uv.y() * v_axis + distance * normal;
  }
  std::vector<Eigen::Vector3d> ToWorld(const Polygon2& loop) const {
    std::vector<Eigen::Vector3d> corners;
    for (const Eigen::Vector2d& uv : loop) corners.push_back(ToWorld(uv));
    return corners;
  }
};

PlaneOfFaces HorizontalPlane(double height, bool faces_up, const PlanarRegion& footprint) {
  PlaneOfFaces plane;
  const double sign = faces_up ? 1.0 : -1.0;
  plane.normal = Eigen::Vector3d(0.0, 0.0, sign);
  plane.distance = sign * height;
  plane.u_axis = Eigen::Vector3d::UnitX();
  plane.v_axis = sign * Eigen::Vector3d::UnitY();
  if (faces_up) {
    plane.region = footprint;
    return plane;
  }
  for (const PolygonWithHoles& polygon : footprint.Polygons()) {
    const auto mirrored = [](Polygon2 loop) {
      for (Eigen::Vector2d& p : loop) p.y() = -p.y();
      return loop;
    };
    plane.region.Join(mirrored(polygon.outer));
    for (const Polygon2& hole : polygon.holes) plane.region.Subtract(mirrored(hole));
  }
  return plane;
}

double Rounded(double coordinate) {
  return std::round(coordinate / kCoordinateStep) * kCoordinateStep;
}

// The rectangles above an arc's edges, whose free side is to the left.
struct PieceOnCircle {
  size_t circle = 0;
  Eigen::Vector2d a;
  Eigen::Vector2d b;
  Layer layer;
};

// The circle that an edge is a chord of, one that ReadFloorPlan has made.
std::optional<size_t> CircleOf(const Eigen::Vector2d& a,
                               const Eigen::Vector2d& b,
                               const std::vector<PlanCircle>& circles) {
  constexpr double kMaxSagitta = 2e-4;  // m
  for (size_t i = 0; i < circles.size(); ++i) {
    const auto off = [&](const Eigen::Vector2d& p) {
      return std::abs((p - circles[i].centre).norm() - circles[i].radius_m);
    };
    if (off(a) < kSamePlane && off(b) < kSamePlane && off(0.5 * (a + b)) < kMaxSagitta) {
      return i;
    }
  }
  return std::nullopt;
}

// Adds the rectangle above the edge from a to b, whose free side is to the left.
void AddWallPiece(const Eigen::Vector2d& a,
                  const Eigen::Vector2d& b,
                  const Layer& layer,
                  std::vector<PlaneOfFaces>* planes) {
  const Eigen::Vector2d direction = (b - a).normalized();
  // Adding zero turns -0 into 0, which looks better in files.
  const Eigen::Vector3d normal(0.0 - direction.y(), 0.0 + direction.x(), 0.0);
  const double distance = normal.head<2>().dot(a);
  auto plane = std::find_if(planes->begin(), planes->end(), [&](const PlaneOfFaces& p) {
    return (p.normal - normal).norm() < kSamePlane &&
           std::abs(p.normal.head<2>().dot(a) - p.distance) < kSamePlane &&
           std::abs(p.normal.head<2>().dot(b) - p.distance) < kSamePlane;
  });
  if (plane == planes->end()) {
    PlaneOfFaces& added = planes->emplace_back();
    added.normal = normal;
    added.distance = distance;
    added.u_axis = -Eigen::Vector3d(direction.x(), direction.y(), 0.0);
    added.v_axis = Eigen::Vector3d::UnitZ();
    plane = planes->end() - 1;
  }
  const double u_a = Rounded(plane->u_axis.head<2>().dot(a));
  const double u_b = Rounded(plane->u_axis.head<2>().dot(b));
  plane->region.Join(
      {{u_b, layer.bottom}, {u_a, layer.bottom}, {u_a, layer.top}, {u_b, layer.top}});
}

void CheckEdges(const Polygon2& loop, const std::string& location) {
  for (size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector2d& a = loop[i];
    if ((loop[(i + 1) % loop.size()] - a).norm() >= kMinEdge) continue;
    std::ostringstream message;
    message << location << ": walls that do not quite meet leave a face of less than "
            << kMinEdge << " m at (" << a.x() << ", " << a.y() << ")";
    throw Error(message.str());
  }
}

std::vector<PlaneOfFaces> VerticalPlanes(const std::vector<Layer>& layers,
                                         const std::vector<PlanCircle>& circles,
                                         const std::string& location,
                                         std::vector<PieceOnCircle>* on_circles) {
  std::vector<PlaneOfFaces> planes;
  for (const Layer& layer : layers) {
    for (const PolygonWithHoles& polygon : layer.free_space.Polygons()) {
      std::vector<Polygon2> loops = polygon.holes;
      loops.insert(loops.begin(), polygon.outer);
      for (const Polygon2& loop : loops) {
        CheckEdges(loop, location);
        for (size_t i = 0; i < loop.size(); ++i) {
          const Eigen::Vector2d& a = loop[i];
          const Eigen::Vector2d& b = loop[(i + 1) % loop.size()];
          const std::optional<size_t> circle = CircleOf(a, b, circles);
          if (circle) {
            on_circles->push_back({*circle, a, b, layer});
          } else {
            AddWallPiece(a, b, layer, &planes);
          }
        }
      }
    }
  }
  return planes;
}

// Adds a face for the pieces on one circle that follow each other.
void AddCylinders(const std::vector<PieceOnCircle>& pieces,
                  const std::vector<PlanCircle>& circles,
                  std::vector<Face>* faces) {
  for (size_t first = 0; first < pieces.size();) {
    size_t end = first + 1;
    while (end < pieces.size() && pieces[end].circle == pieces[first].circle &&
           pieces[end].layer.bottom == pieces[first].layer.bottom &&
           (pieces[end].a - pieces[end - 1].b).norm() < kSamePlane) {
      ++end;
    }
    const PlanCircle& circle = circles[pieces[first].circle];
    const Layer& layer = pieces[first].layer;
    const auto at = [](const Eigen::Vector2d& p, double z) {
      return Eigen::Vector3d(p.x(), p.y(), z);
    };
    Face& face = faces->emplace_back();
    face.id = static_cast<int>(faces->size()) - 1;
    face.type = PlaneType::kCylinder;
    const Eigen::Vector2d middle = pieces[first + (end - first) / 2].a;
    const Eigen::Vector2d along = pieces[first].b - pieces[first].a;
    const Eigen::Vector2d from_centre = pieces[first].a - circle.centre;
    const double side = -along.y() * from_centre.x() + along.x() * from_centre.y();
    face.curvature = std::copysign(1.0 / circle.radius_m, side);
    face.normal = at((middle - circle.centre) * face.curvature, 0.0);
    face.distance = face.normal.head<2>().dot(middle);
    face.middle = at(middle, 0.5 * (layer.bottom + layer.top));
    for (size_t i = first; i < end; ++i) face.outline.push_back(at(pieces[i].a, layer.bottom));
    face.outline.push_back(at(pieces[end - 1].b, layer.bottom));
    face.outline.push_back(at(pieces[end - 1].b, layer.top));
    for (size_t i = end; i > first; --i)
      face.outline.push_back(at(pieces[i - 1].a, layer.top));
    // The free space lies to the left: seen from there, the edges run from right to left.
    std::reverse(face.outline.begin(), face.outline.end());
    for (size_t i = first; i < end; ++i) {
      const Eigen::Vector3d a = at(pieces[i].a, layer.bottom);
      const Eigen::Vector3d b = at(pieces[i].b, layer.bottom);
      const Eigen::Vector3d up(0.0, 0.0, layer.top - layer.bottom);
      face.triangles.push_back({b, a, a + up});
      face.triangles.push_back({b, a + up, b + up});
    }
    first = end;
  }
}

void AddFaces(const PlaneOfFaces& plane, PlaneType type, std::vector<Face>* faces) {
  for (const PolygonWithHoles& polygon : plane.region.Polygons()) {
    Face& face = faces->emplace_back();
    face.id = static_cast<int>(faces->size()) - 1;
    face.type = type;
    face.normal = plane.normal;
    face.distance = plane.distance;
    face.outline = plane.ToWorld(polygon.outer);
    for (const Polygon2& hole : polygon.holes) face.holes.push_back(plane.ToWorld(hole));
    for (const auto& [a, b, c] : Triangulate(polygon)) {
      face.triangles.push_back({plane.ToWorld(a), plane.ToWorld(b), plane.ToWorld(c)});
    }
  }
}

}  // namespace

double Face::Area() const {
  double area = 0.0;
  for (const auto& [a, b, c] : triangles) area += (b - a).cross(c - a).norm() / 2;
  return area;
}

Eigen::Vector3d Face::Centroid() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (curvature != 0.0) return middle;
  for (const auto& [a, b, c] : triangles) {
    sum += (b - a).cross(c - a).norm() / 2 * (a + b + c) / 3;
  }
  return sum / Area();
}

Building MakeBuilding(const FloorPlan& plan) {
  const std::vector<Layer> layers = MakeLayers(plan);
  Building building;
  building.floor_height = plan.floor_height;
  building.ceiling_height = plan.ceiling_height;
  std::vector<Face>* faces = &building.faces;
  AddFaces(HorizontalPlane(plan.floor_height, true, layers.front().free_space),
           PlaneType::kHorizontal,
           faces);
  if (faces->empty()) throw Error(plan.location + ": the building has no free space");
  AddFaces(HorizontalPlane(plan.ceiling_height, false, layers.back().free_space),
           PlaneType::kHorizontal,
           faces);
  std::vector<PieceOnCircle> on_circles;
  for (const PlaneOfFaces& plane :
       VerticalPlanes(layers, plan.circles, plan.location, &on_circles)) {
    AddFaces(plane, PlaneType::kVertical, faces);
  }
  AddCylinders(on_circles, plan.circles, faces);
  for (size_t i = 0; i + 1 < layers.size(); ++i) {
    PlanarRegion underside = layers[i].free_space;
    underside.Subtract(layers[i + 1].free_space);
    AddFaces(HorizontalPlane(layers[i].top, false, underside), PlaneType::kHorizontal, faces);
  }
  for (const Furniture& piece : plan.furniture) AddFurniture(piece, plan.floor_height, faces);
  return building;
}

Building ReadBuilding(const std::string& path, const std::set<int>& dropped) {
  if (std::filesystem::path(path).extension() == ".ply") {
    return MakeBuilding(ReadTriangleMesh(path), dropped);
  }
  return MakeBuilding(ReadFloorPlan(path));
}

}  // namespace plumbline
