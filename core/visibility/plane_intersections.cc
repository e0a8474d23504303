#include "core/visibility/plane_intersections.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/surface/landmark_view.h"
#include "core/surface/patch_extent.h"
#include "core/visibility/beam_tests.h"

namespace plumbline {
namespace {

// Whether all that was seen of the other plane lies behind this one without touching it.
bool IsBehind(const LandmarkView& other, const LandmarkView& own) {
  const PatchExtent& extent = other.landmark->extent;
  for (const double u : {extent.min_corner().x(), extent.max_corner().x()}) {
    for (const double v : {extent.min_corner().y(), extent.max_corner().y()}) {
      const Eigen::Vector3d corner = extent.ToWorld({u, v});
      if (own.SignedDistance(corner) > -kMinDepth) return false;
    }
  }
  return true;
}

// The intersection of the trace with the other plane's patch, if there is one; middle:
// direction of the segment's middle.
std::optional<PlaneIntersection> Meet(const PlaneOnScanLine& own,
                                      const LandmarkView& other,
                                      const FreeEnd& end,
                                      const Eigen::Vector2d& middle) {
  const ScanLine& scan_line = own.scan_line;
  const Trace other_trace(own.placement, other);
  const std::optional<Eigen::Vector2d> at = Crossing(own.trace, other_trace);
  if (!at) return std::nullopt;
  // No two points of a line are half a turn apart: the sign shows the side of the middle.
  const double turn_from_middle = middle.x() * at->y() - middle.y() * at->x();
  if (turn_from_middle * end.step * scan_line.angle_increment < 0.0) return std::nullopt;
  const auto to_world = [&](const Eigen::Vector2d& p) -> Eigen::Vector3d {
    return own.placement * p.homogeneous();
  };
  const Eigen::Vector3d at_world = to_world(*at);
  if (!other.landmark->extent.IsNear(at_world, at_world, kSeenReach)) return std::nullopt;
  const double beyond = end.step * scan_line.BeamsTo(std::atan2(at->y(), at->x()), end.beam);
  const bool is_free = beyond < end.step * (end.limit - end.beam);
  if (!is_free && other.landmark->id != end.neighbour_landmark) return std::nullopt;
  Eigen::Vector3d outwards = at_world - to_world(own.trace.RangeAlong(middle) * middle);
  // Walls cross in an upright line: a sloping trace would leave the patch by its lower edge.
  const bool at_wall = other.traits.bounds_floors;
  const bool are_walls = at_wall && own.plane.traits.bounds_floors;
  if (are_walls) outwards.z() = 0.0;
  outwards.normalize();
  const PatchExtent& own_extent = own.plane.landmark->extent;
  if (IsBehind(other, own.plane)) {
    // It bounds the segment all the same where this plane ends at their intersection.
    const Eigen::Vector3d beyond = at_world + kSeenReach * outwards;
    if (own_extent.IsNear(beyond, beyond, 0.0)) return std::nullopt;
  }
  // The middle beam of a segment that does not belong there may pass its plane by.
  const bool at_upright_edge = are_walls && outwards.allFinite();
  // Close to its own rim a wall has not been seen beyond a floor or ceiling.
  const bool goes_on = at_upright_edge
                           ? own_extent.GoesOnBeyond(at_world, outwards)
                           : own_extent.Contains(own_extent.Project(at_world), -kSeenReach);
  const bool is_turned_away = other.SignedDistance(own.placement.col(2)) < 0.0;
  return PlaneIntersection{static_cast<int>(std::floor(beyond)),
                           other_trace,
                           at_wall,
                           goes_on,
                           at_upright_edge && is_turned_away && !goes_on};
}

}  // namespace

std::vector<PlaneIntersection> FindIntersections(const PlaneOnScanLine& own,
                                                 const Eigen::Vector3d& p_world,
                                                 const PlaneSet& others,
                                                 const FreeEnd& end) {
  std::vector<PlaneIntersection> intersections;
  const Eigen::Vector2d middle = own.scan_line.BeamDirection(end.middle);
  others.ForEachWithin(p_world, kConcernReach, [&](const LandmarkView& other) {
    if (other.landmark == own.plane.landmark) return;
    const auto intersection = Meet(own, other, end, middle);
    if (intersection) intersections.push_back(*intersection);
  });
  std::sort(
      intersections.begin(),
      intersections.end(),
      [](const PlaneIntersection& a, const PlaneIntersection& b) { return a.last > b.last; });
  return intersections;
}

}  // namespace plumbline
