#include "core/outputs/room_measures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "core/outputs/plan_scales.h"
#include "core/outputs/room_outlines.h"
#include "core/outputs/wall_faces.h"

namespace plumbline {
namespace {

// A straight edge of a room.
struct Side {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
  Eigen::Vector2d along;   // unit
  Eigen::Vector2d inward;  // unit
  int plane_id = -1;
  double length() const { return (to - from).norm(); }
};

std::vector<Side> SidesOf(const Room& room, double min_length_m) {
  std::vector<Side> sides;
  for (const RoomLoop& loop : room.loops) {
    for (size_t i = 0; i < loop.size(); ++i) {
      Side side;
      side.from = loop[i].from;
      side.to = loop[(i + 1) % loop.size()].from;
      side.plane_id = loop[i].plane_id;
      if (side.plane_id < 0 || side.length() < min_length_m) continue;
      side.along = (side.to - side.from) / side.length();
      side.inward = {-side.along.y(), side.along.x()};
      sides.push_back(side);
    }
  }
  return sides;
}

// The stretch of side a that lies opposite of side b, as distances from a's begin.
struct Overlap {
  double from = 0.0;
  double to = 0.0;
  double length() const { return to - from; }
  double middle() const { return 0.5 * (from + to); }
};

Overlap OverlapOf(const Side& a, const Side& b) {
  const double one = a.along.dot(b.from - a.from);
  const double other = a.along.dot(b.to - a.from);
  return {std::max(0.0, std::min(one, other)), std::min(a.length(), std::max(one, other))};
}

Eigen::Vector3d AtHeight(const Eigen::Vector2d& p, double z) { return {p.x(), p.y(), z}; }

// How far the line of b lies from p along a's inward normal.
double DistanceTo(const Side& a, const Side& b, const Eigen::Vector2d& p) {
  return b.inward.dot(b.from - p) / b.inward.dot(a.inward);
}

void MeasureArea(const PlaneCovariance& planes, const StoreyLevel& level, Room* room) {
  std::unordered_map<int, const PlanePatch*> by_id;
  for (const PlanePatch& plane : planes.planes()) by_id[plane.id] = &plane;
  std::vector<PlaneCovariance::WeightedDistance> terms;
  double unseen_variance = 0.0;  // m^4
  room->area_m2 = 0.0;
  room->unseen_m = 0.0;
  room->perimeter_m = 0.0;
  for (const RoomLoop& loop : room->loops) {
    room->area_m2 += LoopArea(loop);
    for (size_t i = 0; i < loop.size(); ++i) {
      const Eigen::Vector2d& a = loop[i].from;
      const Eigen::Vector2d& b = loop[(i + 1) % loop.size()].from;
      const double length = (b - a).norm();
      if (&loop == &room->loops.front()) room->perimeter_m += length;
      const double unseen_m = std::max(0.0, length - loop[i].closed_m);
      room->unseen_m += unseen_m;
      // The root mean square of what unseen pieces were off in the shipped buildings.
      unseen_variance += std::pow(kSameM * unseen_m, 2);
      if (loop[i].plane_id < 0) continue;
      const PlanePatch& plane = *by_id.at(loop[i].plane_id);
      const Eigen::Vector3d middle = AtHeight(0.5 * (a + b), level.section_m());
      const Eigen::Vector3d normal = plane.NormalAt(middle);
      // The edge moves by less than the distance where the surface leans: by its level share.
      const Eigen::Vector2d inward(-(b - a).y(), (b - a).x());
      const double side = normal.head<2>().dot(inward) > 0.0 ? 1.0 : -1.0;
      terms.push_back({plane.id, middle, side * length / normal.head<2>().norm()});
      room->area_m2 += plane.AreaBehindChord(length);
    }
  }
  room->area_stddev_m2 = std::hypot(planes.SumStddev(terms), std::sqrt(unseen_variance));
}

// The point of the room that is farthest from its edges, to about 0.1 m.
Eigen::Vector2d InnerPoint(const Room& room) {
  Eigen::AlignedBox2d box;
  for (const RoomEdge& edge : room.loops.front()) box.extend(edge.from);
  Eigen::Vector2d best = box.center();
  double best_distance = -1.0;
  for (double x = box.min().x() + 0.5 * kSameM; x < box.max().x(); x += kSameM) {
    for (double y = box.min().y() + 0.5 * kSameM; y < box.max().y(); y += kSameM) {
      const Eigen::Vector2d p(x, y);
      if (!IsInside(room.loops, p)) continue;
      double distance = 1e9;
      for (const RoomLoop& loop : room.loops) {
        for (size_t i = 0; i < loop.size(); ++i) {
          const Eigen::Vector2d& a = loop[i].from;
          const Eigen::Vector2d u = loop[(i + 1) % loop.size()].from - a;
          const double share = std::clamp((p - a).dot(u) / u.squaredNorm(), 0.0, 1.0);
          distance = std::min(distance, (a + share * u - p).norm());
        }
      }
      // Ties go to the middle of the room's box.
      distance -= 1e-3 * (p - box.center()).norm();
      if (distance > best_distance) {
        best_distance = distance;
        best = p;
      }
    }
  }
  return best;
}

// Returns the level surface over the label, between two heights, with most points.
const PlanePatch* LevelSurface(const std::vector<PlanePatch>& planes,
                               const Eigen::Vector2d& label,
                               double direction,
                               double low_m,
                               double high_m) {
  const PlanePatch* found = nullptr;
  for (const PlanePatch& plane : planes) {
    if (plane.normal.z() * direction < 1.0) continue;  // it faces another way, or is not level
    if (plane.centre.z() < low_m || plane.centre.z() > high_m) continue;
    if (found != nullptr && found->num_points >= plane.num_points) continue;
    if (CoversInPlan(plane.outline, label, kOutlineMarginM)) found = &plane;
  }
  return found;
}

void MeasureHeight(const PlaneCovariance& planes, const StoreyLevel& level, Room* room) {
  constexpr double kStepM = 0.6;  // of a room's floor or ceiling from the storey's
  if (!level.has_floor) return;
  const StoreyHeights heights = level.At(room->label);
  const PlanePatch* floor = LevelSurface(
      planes.planes(), room->label, 1.0, heights.floor_m - kStepM, heights.floor_m + kStepM);
  const PlanePatch* ceiling = LevelSurface(planes.planes(),
                                           room->label,
                                           -1.0,
                                           heights.floor_m + kMinClearM,
                                           heights.top_m + kStepM);
  if (floor != nullptr) room->floor_m = floor->centre.z();
  if (ceiling != nullptr) room->ceiling_m = ceiling->centre.z();
  if (floor != nullptr && ceiling != nullptr) {
    room->height_stddev_m = planes.SeparationStddev(
        AtHeight(room->label, floor->centre.z()), floor->id, ceiling->id);
  }
}

// Two walls of a room that face each other.
struct OppositeSides {
  Side a;
  Side b;
  Overlap overlap;
};

// The clear distance at a place along side a; none where something stands between.
std::optional<Dimension> DimensionAt(const OppositeSides& sides,
                                     double place,
                                     const Room& room) {
  const Side& a = sides.a;
  const Eigen::Vector2d from = a.from + place * a.along;
  const double length = DistanceTo(a, sides.b, from);
  if (length <= 0.0) return std::nullopt;
  const int count = static_cast<int>(length / WallFace::kColumnM) + 1;
  for (int i = 0; i < count; ++i) {
    if (!IsInside(room.loops, from + (i + 0.5) / count * length * a.inward)) {
      return std::nullopt;
    }
  }
  return Dimension{from, from + length * a.inward, a.plane_id, sides.b.plane_id, length, 0.0};
}

// The distance of two walls near one end of the walls, where lines and texts are out of the
// label's way; else near the other end, else in the middle.
std::optional<Dimension> MeasureBetween(const OppositeSides& sides, const Room& room) {
  constexpr double kPlaceShare = 0.25;
  constexpr double kMaxPlaceM = 0.45;
  const Overlap& overlap = sides.overlap;
  const double inset = std::min(kPlaceShare * overlap.length(), kMaxPlaceM);
  double near = overlap.from + inset;
  double far = overlap.to - inset;
  if (sides.a.along.dot(room.label - sides.a.from) <= overlap.middle()) std::swap(near, far);
  for (const double place : {near, far, overlap.middle()}) {
    const std::optional<Dimension> dimension = DimensionAt(sides, place, room);
    if (dimension) return dimension;
  }
  return std::nullopt;
}

// The pairs of opposite walls, those first that face each other on the greatest length.
std::vector<OppositeSides> FindOppositeSides(const Room& room) {
  std::vector<OppositeSides> pairs;
  const std::vector<Side> sides = SidesOf(room, kMinWallM);
  for (size_t i = 0; i < sides.size(); ++i) {
    for (size_t k = i + 1; k < sides.size(); ++k) {
      if (sides[i].inward.dot(sides[k].inward) > -kParallelCosine) continue;
      const Overlap overlap = OverlapOf(sides[i], sides[k]);
      if (overlap.length() >= kMinWallM) pairs.push_back({sides[i], sides[k], overlap});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) {
    return a.overlap.length() > b.overlap.length();
  });
  return pairs;
}

// The clear distances of the room: of each direction the opposite walls that face each other
// on the greatest length, and others that are clearly farther from each other or nearer.
void MeasureDimensions(const PlaneCovariance& planes, const StoreyLevel& level, Room* room) {
  constexpr int kMaxPerDirection = 2;
  for (const OppositeSides& sides : FindOppositeSides(*room)) {
    std::optional<Dimension> dimension = MeasureBetween(sides, *room);
    if (!dimension) continue;
    const Eigen::Vector2d direction = (dimension->to - dimension->from).normalized();
    int same = 0;
    bool is_known = false;
    for (const Dimension& other : room->dimensions) {
      if (std::abs(direction.dot((other.to - other.from).normalized())) < kParallelCosine) {
        continue;
      }
      ++same;
      is_known = is_known || std::abs(other.length_m - dimension->length_m) < kMinWallM;
    }
    if (is_known || same >= kMaxPerDirection) continue;
    dimension->stddev_m = planes.SeparationStddev(
        AtHeight(dimension->from, level.section_m()), dimension->plane_a, dimension->plane_b);
    room->dimensions.push_back(*dimension);
  }
}

}  // namespace

void MeasureRoom(const PlaneCovariance& planes, const StoreyLevel& level, Room* room) {
  room->label = InnerPoint(*room);
  MeasureArea(planes, level, room);
  MeasureHeight(planes, level, room);
  MeasureDimensions(planes, level, room);
}

std::vector<WallPiece> FindWalls(const PlaneCovariance& planes,
                                 const StoreyLevel& level,
                                 const std::vector<Room>& rooms) {
  std::vector<Side> sides;
  for (const Room& room : rooms) {
    const std::vector<Side> of_room = SidesOf(room, kMinWallM);
    sides.insert(sides.end(), of_room.begin(), of_room.end());
  }
  std::vector<WallPiece> walls;
  for (size_t i = 0; i < sides.size(); ++i) {
    for (size_t k = i + 1; k < sides.size(); ++k) {
      const Side& a = sides[i];
      const Side& b = sides[k];
      if (a.inward.dot(b.inward) > -kParallelCosine) continue;
      const Overlap overlap = OverlapOf(a, b);
      if (overlap.length() < kMinWallM) continue;
      const Eigen::Vector2d middle = a.from + overlap.middle() * a.along;
      const double thickness = -DistanceTo(a, b, middle);  // b lies behind a
      if (thickness <= 0.0 || thickness > kMaxThicknessM) continue;
      WallPiece wall;
      const Eigen::Vector2d p = a.from + overlap.from * a.along;
      const Eigen::Vector2d q = a.from + overlap.to * a.along;
      wall.corners = {
          p, q, q + DistanceTo(a, b, q) * a.inward, p + DistanceTo(a, b, p) * a.inward};
      wall.plane_a = a.plane_id;
      wall.plane_b = b.plane_id;
      wall.thickness_m = thickness;
      wall.stddev_m =
          planes.SeparationStddev(AtHeight(middle, level.section_m()), a.plane_id, b.plane_id);
      walls.push_back(wall);
    }
  }
  return walls;
}

}  // namespace plumbline
