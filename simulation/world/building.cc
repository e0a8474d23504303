#include "simulation/world/building.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>

#include "core/util/error.h"
#include "simulation/world/face_pieces.h"
#include "simulation/world/furniture.h"
#include "simulation/world/mesh_building.h"
#include "simulation/world/sloped_building.h"

namespace plumbline {
namespace {

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
    for (const Polygon2& footprint : wall.FootprintsBeside(open)) region.Subtract(footprint);
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
    FailOfShortEdge(location, a);
  }
}

std::vector<PlaneOfFaces> VerticalPlanes(const std::vector<Layer>& layers,
                                         const std::vector<PlanCircle>& circles,
                                         const std::string& location,
                                         std::vector<ArcPiece>* on_circles) {
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
          const std::optional<size_t> circle = FindCircle(a, b, circles);
          if (circle) {
            on_circles->push_back(
                {*circle, a, b, layer.bottom, layer.bottom, layer.top, layer.top});
          } else {
            AddWallPiece(a, b, layer, &planes);
          }
        }
      }
    }
  }
  return planes;
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

std::vector<Eigen::Vector3d> Face::OutlineOfPieces() const {
  std::vector<Eigen::Vector3d> all = outline;
  for (const std::vector<Eigen::Vector3d>& loop : holes) {
    Eigen::Vector3d twice_area = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < loop.size(); ++i) {
      twice_area += loop[i].cross(loop[(i + 1) % loop.size()]);
    }
    if (curvature != 0.0 || twice_area.dot(normal) <= 0.0) continue;  // a hole
    all.insert(all.end(), loop.begin(), loop.end());
    all.push_back(loop.front());
    all.push_back(outline.front());
  }
  return all;
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
  std::vector<ArcPiece> on_circles;
  for (const PlaneOfFaces& plane :
       VerticalPlanes(layers, plan.circles, plan.location, &on_circles)) {
    AddFaces(plane, PlaneType::kVertical, faces);
  }
  AddArcFaces(on_circles, plan.circles, faces);
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
  const std::vector<FloorPlan> storeys = ReadFloorPlans(path);
  const bool is_level = storeys.size() == 1 && storeys.front().IsLevel();
  return is_level ? MakeBuilding(storeys.front()) : MakeSlopedBuilding(storeys);
}

}  // namespace plumbline
