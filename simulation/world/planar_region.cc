#include "simulation/world/planar_region.h"

#include <CGAL/Boolean_set_operations_2.h>
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <CGAL/Polygon_set_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <iterator>
#include <utility>

namespace plumbline {
namespace {

using ExactKernel = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactPolygon = CGAL::Polygon_2<ExactKernel>;
using ExactPolygonWithHoles = CGAL::Polygon_with_holes_2<ExactKernel>;
using ExactRegion = CGAL::Polygon_set_2<ExactKernel>;

constexpr double kSamePoint = 1e-6;      // m; far below what a building file tells apart
constexpr double kSameDirection = 1e-7;  // rad; a micrometre over 10 m

// Corners that rounding alone holds apart leave slivers, on which the sweep of CGAL's Boolean
// operations has crashed.
double RoundedToNanometres(double metres) { return std::round(1e9 * metres) / 1e9; }

ExactPolygon ToExact(const Polygon2& polygon) {
  ExactPolygon exact;
  for (const Eigen::Vector2d& p : polygon) {
    exact.push_back({RoundedToNanometres(p.x()), RoundedToNanometres(p.y())});
  }
  if (exact.orientation() == CGAL::CLOCKWISE) exact.reverse_orientation();
  return exact;
}

// False when rounding has left nothing but a line, which CGAL's Boolean operations do not
// take.
bool HasArea(const ExactPolygon& polygon) { return polygon.orientation() != CGAL::COLLINEAR; }

// True when the boundary runs straight on at the corner, or back on itself.
bool IsRedundant(const Eigen::Vector2d& before,
                 const Eigen::Vector2d& corner,
                 const Eigen::Vector2d& after) {
  const Eigen::Vector2d in = corner - before;
  const Eigen::Vector2d out = after - corner;
  if (in.norm() < kSamePoint || out.norm() < kSamePoint) return true;
  const double cross = in.x() * out.y() - in.y() * out.x();
  return std::abs(cross) < kSameDirection * in.norm() * out.norm();
}

bool LexicographicallyLess(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
}

bool PolygonLess(const Polygon2& a, const Polygon2& b) {
  return std::lexicographical_compare(
      a.begin(), a.end(), b.begin(), b.end(), LexicographicallyLess);
}

// Rounded to doubles, without redundant corners, starting at the smallest corner. Empty when
// nothing is left.
Polygon2 Simplified(const ExactPolygon& exact) {
  Polygon2 polygon;
  for (auto p = exact.vertices_begin(); p != exact.vertices_end(); ++p) {
    polygon.emplace_back(CGAL::to_double(p->x()), CGAL::to_double(p->y()));
  }
  for (size_t i = 0, unchanged = 0; unchanged < polygon.size() && polygon.size() >= 3;) {
    const size_t size = polygon.size();
    i %= size;
    if (IsRedundant(polygon[(i + size - 1) % size], polygon[i], polygon[(i + 1) % size])) {
      polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(i));
      i = (i + size - 2) % (size - 1);  // the corner before may have become redundant
      unchanged = 0;
    } else {
      ++i;
      ++unchanged;
    }
  }
  if (polygon.size() < 3) return {};
  std::rotate(polygon.begin(),
              std::min_element(polygon.begin(), polygon.end(), LexicographicallyLess),
              polygon.end());
  return polygon;
}

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
constexpr int kUnknownNesting = -1;
struct FaceInfo {
  int nesting = kUnknownNesting;  // number of boundaries between here and infinity
};
using FaceBase = CGAL::Triangulation_face_base_with_info_2<
    FaceInfo,
    Kernel,
    CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using TriangulationData =
    CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_2<Kernel>, FaceBase>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel,
                                                                 TriangulationData,
                                                                 CGAL::Exact_predicates_tag>;

void InsertLoop(const Polygon2& loop, Triangulation* triangulation) {
  for (size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector2d& a = loop[i];
    const Eigen::Vector2d& b = loop[(i + 1) % loop.size()];
    triangulation->insert_constraint({a.x(), a.y()}, {b.x(), b.y()});
  }
}

void MarkNesting(Triangulation* triangulation) {
  // Faces across a boundary go to the back, so that nestings are met in increasing order.
  std::deque<std::pair<Triangulation::Face_handle, int>> open = {
      {triangulation->infinite_face(), 0}};
  while (!open.empty()) {
    const auto [face, nesting] = open.front();
    open.pop_front();
    if (face->info().nesting != kUnknownNesting) continue;
    face->info().nesting = nesting;
    for (int i = 0; i < 3; ++i) {
      if (face->is_constrained(i)) {
        open.push_back({face->neighbor(i), nesting + 1});
      } else {
        open.push_front({face->neighbor(i), nesting});
      }
    }
  }
}

}  // namespace

bool Contains(const Polygon2& polygon, const Eigen::Vector2d& place) {
  bool is_inside = false;
  for (size_t i = 0, before = polygon.size() - 1; i < polygon.size(); before = i++) {
    const Eigen::Vector2d& a = polygon[before];
    const Eigen::Vector2d& b = polygon[i];
    if ((a.y() > place.y()) == (b.y() > place.y())) continue;
    const double x = a.x() + (place.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    is_inside ^= place.x() < x;
  }
  return is_inside;
}

bool IsSimplePolygon(const Polygon2& polygon) {
  if (polygon.size() < 3) return false;
  CGAL::Polygon_2<Kernel> p;
  for (const Eigen::Vector2d& corner : polygon) p.push_back({corner.x(), corner.y()});
  return p.is_simple() && p.orientation() != CGAL::COLLINEAR;
}

struct PlanarRegion::Impl {
  ExactRegion region;
};

PlanarRegion::PlanarRegion() : impl_(std::make_unique<Impl>()) {}
PlanarRegion::PlanarRegion(const PlanarRegion& other)
    : impl_(std::make_unique<Impl>(*other.impl_)) {}
PlanarRegion& PlanarRegion::operator=(const PlanarRegion& other) {
  *impl_ = *other.impl_;
  return *this;
}
PlanarRegion::~PlanarRegion() = default;

void PlanarRegion::Join(const Polygon2& polygon) {
  const ExactPolygon exact = ToExact(polygon);
  if (HasArea(exact)) impl_->region.join(exact);
}

void PlanarRegion::Join(const std::vector<Polygon2>& polygons) {
  std::vector<ExactPolygon> exact;
  for (const Polygon2& polygon : polygons) {
    exact.push_back(ToExact(polygon));
    if (!HasArea(exact.back())) exact.pop_back();
  }
  impl_->region.join(exact.begin(), exact.end());
}

void PlanarRegion::Subtract(const Polygon2& polygon) {
  impl_->region.difference(ToExact(polygon));
}

void PlanarRegion::Subtract(const PlanarRegion& other) {
  impl_->region.difference(other.impl_->region);
}

std::vector<PolygonWithHoles> PlanarRegion::Polygons() const {
  std::vector<ExactPolygonWithHoles> exact;
  impl_->region.polygons_with_holes(std::back_inserter(exact));
  std::vector<PolygonWithHoles> polygons;
  for (const ExactPolygonWithHoles& piece : exact) {
    PolygonWithHoles polygon;
    polygon.outer = Simplified(piece.outer_boundary());
    if (polygon.outer.empty()) continue;
    for (auto hole = piece.holes_begin(); hole != piece.holes_end(); ++hole) {
      Polygon2 loop = Simplified(*hole);
      if (!loop.empty()) polygon.holes.push_back(std::move(loop));
    }
    std::sort(polygon.holes.begin(), polygon.holes.end(), PolygonLess);
    polygons.push_back(std::move(polygon));
  }
  std::sort(polygons.begin(), polygons.end(), [](const auto& a, const auto& b) {
    return PolygonLess(a.outer, b.outer);
  });
  return polygons;
}

std::vector<std::array<Eigen::Vector2d, 3>> Triangulate(const PolygonWithHoles& polygon) {
  Triangulation triangulation;
  InsertLoop(polygon.outer, &triangulation);
  for (const Polygon2& hole : polygon.holes) InsertLoop(hole, &triangulation);
  MarkNesting(&triangulation);
  std::vector<std::array<Eigen::Vector2d, 3>> triangles;
  for (auto face = triangulation.finite_faces_begin();
       face != triangulation.finite_faces_end();
       ++face) {
    if (face->info().nesting % 2 == 0) continue;
    std::array<Eigen::Vector2d, 3>& triangle = triangles.emplace_back();
    for (int i = 0; i < 3; ++i) {
      const Kernel::Point_2& p = face->vertex(i)->point();
      triangle[static_cast<size_t>(i)] = {p.x(), p.y()};
    }
  }
  return triangles;
}

}  // namespace plumbline
