#include "simulation/world/face_pieces.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/util/error.h"

namespace plumbline {

std::vector<Eigen::Vector3d> PlaneOfFaces::ToWorld(const Polygon2& loop) const {
  std::vector<Eigen::Vector3d> corners;
  for (const Eigen::Vector2d& uv : loop) corners.push_back(ToWorld(uv));
  return corners;
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

bool ArcPiece::IsContinuedBy(const ArcPiece& next) const {
  return next.circle == circle && (next.a - b).norm() < kSamePlane &&
         std::abs(next.bottom_a - bottom_b) < kSamePlane &&
         std::abs(next.top_a - top_b) < kSamePlane;
}

std::optional<size_t> FindCircle(const Eigen::Vector2d& a,
                                 const Eigen::Vector2d& b,
                                 const std::vector<PlanCircle>& circles) {
  constexpr double kMaxSagitta = 2e-4;  // m
  for (size_t i = 0; i < circles.size(); ++i) {
    // A chord may have been cut: its ends then lie as deep within the circle as chords do.
    const auto is_on = [&](const Eigen::Vector2d& p) {
      const double inside = circles[i].radius_m - (p - circles[i].centre).norm();
      return inside > -kSamePlane && inside < kMaxSagitta;
    };
    if (is_on(a) && is_on(b) && is_on(0.5 * (a + b))) return i;
  }
  return std::nullopt;
}

void AddArcFaces(const std::vector<ArcPiece>& pieces,
                 const std::vector<PlanCircle>& circles,
                 std::vector<Face>* faces) {
  const auto at = [](const Eigen::Vector2d& p, double z) {
    return Eigen::Vector3d(p.x(), p.y(), z);
  };
  for (size_t first = 0; first < pieces.size();) {
    size_t end = first + 1;
    while (end < pieces.size() && pieces[end - 1].IsContinuedBy(pieces[end])) ++end;
    const PlanCircle& circle = circles[pieces[first].circle];
    Face& face = faces->emplace_back();
    face.id = static_cast<int>(faces->size()) - 1;
    face.type = PlaneType::kCylinder;
    ArcPiece middle = pieces[first + (end - first) / 2];
    const Eigen::Vector2d spoke = middle.a - circle.centre;
    if (std::abs(spoke.norm() - circle.radius_m) > kSamePlane) {  // where a chord was cut
      middle.a = circle.centre + circle.radius_m * spoke.normalized();
    }
    const Eigen::Vector2d along = pieces[first].b - pieces[first].a;
    const Eigen::Vector2d from_centre = pieces[first].a - circle.centre;
    const double side = -along.y() * from_centre.x() + along.x() * from_centre.y();
    face.curvature = std::copysign(1.0 / circle.radius_m, side);
    face.normal = at((middle.a - circle.centre) * face.curvature, 0.0);
    face.distance = face.normal.head<2>().dot(middle.a);
    face.middle = at(middle.a, 0.5 * (middle.bottom_a + middle.top_a));
    for (size_t i = first; i < end; ++i) {
      face.outline.push_back(at(pieces[i].a, pieces[i].bottom_a));
    }
    face.outline.push_back(at(pieces[end - 1].b, pieces[end - 1].bottom_b));
    face.outline.push_back(at(pieces[end - 1].b, pieces[end - 1].top_b));
    for (size_t i = end; i > first; --i) {
      face.outline.push_back(at(pieces[i - 1].a, pieces[i - 1].top_a));
    }
    // The free space lies to the left: seen from there, the edges run from right to left.
    std::reverse(face.outline.begin(), face.outline.end());
    for (size_t i = first; i < end; ++i) {
      const Eigen::Vector3d a = at(pieces[i].a, pieces[i].bottom_a);
      const Eigen::Vector3d b = at(pieces[i].b, pieces[i].bottom_b);
      const Eigen::Vector3d top_a = at(pieces[i].a, pieces[i].top_a);
      face.triangles.push_back({b, a, top_a});
      face.triangles.push_back({b, top_a, at(pieces[i].b, pieces[i].top_b)});
    }
    first = end;
  }
}

void FailOfShortEdge(const std::string& location, const Eigen::Vector2d& place) {
  std::ostringstream message;
  message << location << ": walls that do not quite meet leave a face of less than "
          << kMinEdge << " m at (" << place.x() << ", " << place.y() << ")";
  throw Error(message.str());
}

}  // namespace plumbline
