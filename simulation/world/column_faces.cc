#include "simulation/world/column_faces.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "simulation/world/face_pieces.h"

namespace plumbline {
namespace {

constexpr double kSamePosition = 1e-7;    // m, in the plan
constexpr double kCoordinateStep = 1e-9;  // m; makes coordinates along a wall comparable

double DoubledArea(const PlanTriangle& triangle) {
  const Eigen::Vector2d u = triangle.corners[1] - triangle.corners[0];
  const Eigen::Vector2d v = triangle.corners[2] - triangle.corners[0];
  return u.x() * v.y() - u.y() * v.x();
}

double EdgeLength(const PlanTriangle& triangle, size_t edge) {
  return (triangle.corners[(edge + 1) % 3] - triangle.corners[edge]).norm();
}

double LongestEdge(const PlanTriangle& triangle) {
  return std::max({EdgeLength(triangle, 0), EdgeLength(triangle, 1), EdgeLength(triangle, 2)});
}

// Free heights above each triangle. Triangles without width, which rounding leaves between
// lines that coincide, take it from a neighbour behind a long edge.
std::vector<FreeColumn> ColumnsOf(const ColumnPlan& plan,
                                  const std::vector<PlanTriangle>& triangles) {
  std::vector<FreeColumn> columns(triangles.size());
  std::vector<size_t> open;
  std::vector<bool> is_known(triangles.size(), true);
  for (size_t i = 0; i < triangles.size(); ++i) {
    const PlanTriangle& triangle = triangles[i];
    if (DoubledArea(triangle) > kSamePosition * LongestEdge(triangle)) {
      columns[i] =
          plan.free_at((triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3);
    } else {
      is_known[i] = false;
      open.push_back(i);
    }
  }
  for (size_t num_open = open.size() + 1; open.size() < num_open;) {
    num_open = open.size();
    std::vector<size_t> still_open;
    for (const size_t i : open) {
      for (size_t edge = 0; edge < 3 && !is_known[i]; ++edge) {
        if (2 * EdgeLength(triangles[i], edge) < LongestEdge(triangles[i])) continue;
        const int neighbour = triangles[i].neighbours[edge];
        if (neighbour != kNoTriangle && !is_known[static_cast<size_t>(neighbour)]) continue;
        if (neighbour != kNoTriangle) columns[i] = columns[static_cast<size_t>(neighbour)];
        is_known[i] = true;
      }
      if (!is_known[i]) still_open.push_back(i);
    }
    open = std::move(still_open);
  }
  return columns;
}

// Floors of one plane, or ceilings.
struct FloorOrCeiling {
  HeightPlane plane;
  bool is_floor = true;
  Eigen::Vector2d place;  // where it is known
  std::vector<Polygon2> triangles;

  bool Is(const HeightPlane& other, bool other_is_floor) const {
    return is_floor == other_is_floor &&
           (plane.gradient - other.gradient).norm() < kSamePlane &&
           std::abs(plane.At(place) - other.At(place)) < kSamePlane;
  }
};

std::vector<FloorOrCeiling> FloorsAndCeilings(const std::vector<PlanTriangle>& triangles,
                                              const std::vector<FreeColumn>& columns) {
  std::vector<FloorOrCeiling> surfaces;
  for (const bool is_floor : {true, false}) {
    for (size_t i = 0; i < triangles.size(); ++i) {
      if (DoubledArea(triangles[i]) <= 0.0) continue;  // none but for rounding
      for (const FreeInterval& interval : columns[i]) {
        const HeightPlane& plane = is_floor ? interval.bottom : interval.top;
        auto known = std::find_if(surfaces.begin(), surfaces.end(), [&](const auto& surface) {
          return surface.Is(plane, is_floor);
        });
        if (known == surfaces.end()) {
          surfaces.push_back({plane, is_floor, triangles[i].corners[0], {}});
          known = surfaces.end() - 1;
        }
        const auto& corners = triangles[i].corners;
        known->triangles.push_back({corners.begin(), corners.end()});
      }
    }
  }
  return surfaces;
}

void AddFacesOf(const FloorOrCeiling& surface, std::vector<Face>* faces) {
  const HeightPlane& plane = surface.plane;
  const auto lifted = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector3d(p.x(), p.y(), plane.At(p));
  };
  const auto lifted_loop = [&](const Polygon2& loop) {
    std::vector<Eigen::Vector3d> corners;
    for (const Eigen::Vector2d& p : loop) corners.push_back(lifted(p));
    // Seen from below, what runs counter-clockwise in the plan runs clockwise.
    if (!surface.is_floor) std::reverse(corners.begin(), corners.end());
    return corners;
  };
  const bool is_level = plane.gradient.norm() < kSamePlane;
  const Eigen::Vector3d up(-plane.gradient.x(), -plane.gradient.y(), 1.0);
  const double sign = surface.is_floor ? 1.0 : -1.0;
  PlanarRegion region;
  region.Join(surface.triangles);
  for (const PolygonWithHoles& polygon : region.Polygons()) {
    Face& face = faces->emplace_back();
    face.type = is_level ? PlaneType::kHorizontal : PlaneType::kGeneral;
    // Adding zero turns -0 into 0, which looks better in files.
    face.normal = sign * up.normalized() + Eigen::Vector3d::Zero();
    face.distance = sign * plane.at_origin / up.norm() + 0.0;
    face.outline = lifted_loop(polygon.outer);
    for (const Polygon2& hole : polygon.holes) face.holes.push_back(lifted_loop(hole));
    for (auto [a, b, c] : Triangulate(polygon)) {
      if (!surface.is_floor) std::swap(b, c);
      face.triangles.push_back({lifted(a), lifted(b), lifted(c)});
    }
  }
}

// Heights that are free in one column and not in the other, at a place where no two planes
// meet.
FreeColumn FreeInOneOnly(FreeColumn one,
                         const FreeColumn& other,
                         const Eigen::Vector2d& place) {
  for (const FreeInterval& interval : other) Fill(interval, place, &one);
  return one;
}

// Shares of the way from a to b, between which no two planes of either column meet.
std::vector<double> SharesBetweenCrossings(const FreeColumn& one,
                                           const FreeColumn& other,
                                           const Eigen::Vector2d& a,
                                           const Eigen::Vector2d& b) {
  std::vector<HeightPlane> planes;
  for (const FreeColumn* column : {&one, &other}) {
    for (const FreeInterval& interval : *column) {
      planes.push_back(interval.bottom);
      planes.push_back(interval.top);
    }
  }
  std::vector<double> crossings;
  for (size_t p = 0; p < planes.size(); ++p) {
    for (size_t q = 0; q < p; ++q) {
      const double at_a = planes[p].At(a) - planes[q].At(a);
      const double at_b = planes[p].At(b) - planes[q].At(b);
      if (std::min(at_a, at_b) > -kSamePlane || std::max(at_a, at_b) < kSamePlane) continue;
      crossings.push_back(at_a / (at_a - at_b));
    }
  }
  std::sort(crossings.begin(), crossings.end());
  const double least_share = kSamePosition / (b - a).norm();
  std::vector<double> shares = {0.0};
  for (const double crossing : crossings) {
    if (crossing - shares.back() > least_share && 1.0 - crossing > least_share) {
      shares.push_back(crossing);
    }
  }
  shares.push_back(1.0);
  return shares;
}

// The upright pieces above edges of the plan.
class UprightPieces {
 public:
  explicit UprightPieces(const std::vector<PlanCircle>& circles) : circles_(circles) {}

  // Takes the faces between two columns that meet along the edge from a to b. The first lies
  // to the left.
  void Add(const Eigen::Vector2d& a,
           const Eigen::Vector2d& b,
           const FreeColumn& left,
           const FreeColumn& right) {
    if ((b - a).norm() < kSamePosition) return;
    const std::optional<size_t> circle = FindCircle(a, b, circles_);
    const std::vector<double> shares = SharesBetweenCrossings(left, right, a, b);
    for (size_t i = 1; i < shares.size(); ++i) {
      ArcPiece piece;
      piece.a = a + shares[i - 1] * (b - a);
      piece.b = shares[i] == 1.0 ? b : Eigen::Vector2d(a + shares[i] * (b - a));
      for (const FreeInterval& free : FreeInOneOnly(left, right, 0.5 * (piece.a + piece.b))) {
        piece.bottom_a = free.bottom.At(piece.a);
        piece.bottom_b = free.bottom.At(piece.b);
        piece.top_a = free.top.At(piece.a);
        piece.top_b = free.top.At(piece.b);
        if (circle) {
          piece.circle = *circle;
          on_arcs_.push_back(piece);
        } else {
          AddPlanar(piece);
        }
      }
    }
  }

  void AddFacesTo(std::vector<Face>* faces) const {
    for (const PlaneOfFaces& plane : planes_) AddFaces(plane, PlaneType::kVertical, faces);
    AddArcFaces(Chained(on_arcs_), circles_, faces);
  }

 private:
  void AddPlanar(const ArcPiece& piece) {
    const Eigen::Vector2d direction = (piece.b - piece.a).normalized();
    const Eigen::Vector3d normal(0.0 - direction.y(), 0.0 + direction.x(), 0.0);
    const auto holds = [](const PlaneOfFaces& plane, const Eigen::Vector2d& p) {
      return std::abs(plane.normal.head<2>().dot(p) - plane.distance) < kSamePlane;
    };
    auto plane = std::find_if(planes_.begin(), planes_.end(), [&](const PlaneOfFaces& p) {
      // Directions of short edges are less sure than the places of their ends.
      return p.normal.dot(normal) > 0.0 && holds(p, piece.a) && holds(p, piece.b);
    });
    if (plane == planes_.end()) {
      PlaneOfFaces& added = planes_.emplace_back();
      added.normal = normal;
      added.distance = normal.head<2>().dot(piece.a);
      added.u_axis = -Eigen::Vector3d(direction.x(), direction.y(), 0.0);
      added.v_axis = Eigen::Vector3d::UnitZ();
      plane = planes_.end() - 1;
    }
    const auto position = [&](const Eigen::Vector2d& p) {
      return std::round(plane->u_axis.head<2>().dot(p) / kCoordinateStep) * kCoordinateStep;
    };
    const double u_a = position(piece.a);
    const double u_b = position(piece.b);
    Polygon2 corners = {{u_b, piece.bottom_b}, {u_a, piece.bottom_a}};
    if (piece.top_a - piece.bottom_a > kSamePlane) corners.emplace_back(u_a, piece.top_a);
    if (piece.top_b - piece.bottom_b > kSamePlane) corners.emplace_back(u_b, piece.top_b);
    plane->region.Join(corners);
  }

  // Brings pieces that continue each other into their order.
  static std::vector<ArcPiece> Chained(std::vector<ArcPiece> pieces) {
    std::vector<ArcPiece> chained;
    while (!pieces.empty()) {
      // A piece that continues no other begins a face; where all do, they go round a circle.
      auto next = std::find_if(pieces.begin(), pieces.end(), [&](const ArcPiece& piece) {
        return std::none_of(pieces.begin(), pieces.end(), [&](const ArcPiece& other) {
          return other.IsContinuedBy(piece);
        });
      });
      if (next == pieces.end()) next = pieces.begin();
      while (next != pieces.end()) {
        chained.push_back(*next);
        pieces.erase(next);
        next = std::find_if(pieces.begin(), pieces.end(), [&](const ArcPiece& piece) {
          return chained.back().IsContinuedBy(piece);
        });
      }
    }
    return chained;
  }

  const std::vector<PlanCircle>& circles_;
  std::vector<PlaneOfFaces> planes_;
  std::vector<ArcPiece> on_arcs_;
};

void CheckEdges(const Face& face, const std::string& location) {
  if (face.type == PlaneType::kCylinder) return;  // chords may be cut anywhere
  std::vector<std::vector<Eigen::Vector3d>> loops = face.holes;
  loops.push_back(face.outline);
  for (const std::vector<Eigen::Vector3d>& loop : loops) {
    for (size_t i = 0; i < loop.size(); ++i) {
      if ((loop[(i + 1) % loop.size()] - loop[i]).norm() >= kMinEdge) continue;
      FailOfShortEdge(location, loop[i].head<2>());
    }
  }
}

}  // namespace

std::vector<Face> MakeColumnFaces(const ColumnPlan& plan) {
  const std::vector<PlanTriangle> triangles = TriangulatePlan(plan.lines);
  const std::vector<FreeColumn> columns = ColumnsOf(plan, triangles);
  std::vector<Face> faces;
  for (const FloorOrCeiling& surface : FloorsAndCeilings(triangles, columns)) {
    AddFacesOf(surface, &faces);
  }
  UprightPieces upright(plan.circles);
  for (size_t i = 0; i < triangles.size(); ++i) {
    for (size_t edge = 0; edge < 3; ++edge) {
      const int neighbour = triangles[i].neighbours[edge];
      upright.Add(
          triangles[i].corners[edge],
          triangles[i].corners[(edge + 1) % 3],
          columns[i],
          neighbour == kNoTriangle ? FreeColumn() : columns[static_cast<size_t>(neighbour)]);
    }
  }
  upright.AddFacesTo(&faces);
  for (size_t i = 0; i < faces.size(); ++i) {
    faces[i].id = static_cast<int>(i);
    CheckEdges(faces[i], plan.location);
  }
  return faces;
}

}  // namespace plumbline
