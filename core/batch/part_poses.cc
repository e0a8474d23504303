#include "core/batch/part_poses.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "core/map/observation_poses.h"
#include "core/surface/landmark_view.h"

namespace plumbline {
namespace {

// One segment on a wall of this number gives a beam.
constexpr int kBeamStride = 4;
// Half the height of the slice about the scanner in which walls and beams are compared: over a
// door there is a wall, and beams pass below it.
constexpr double kHalfSlice = 0.4;  // m

// How far apart neighbouring points of a segment are at its ends, the farther ones: between
// the points of one that is seen along the wall there is room for a door.
double LargestStep(const Observation& observation) {
  const int num_steps = observation.last_beam - observation.first_beam;
  if (num_steps < 1) return observation.length_m();
  const auto angle_between = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
  };
  const double step_rad = angle_between(observation.start(), observation.end()) / num_steps;
  double largest = 0.0;
  for (const Eigen::Vector2d& end : {observation.start(), observation.end()}) {
    const double incidence = std::abs(std::sin(angle_between(end, observation.tangent())));
    largest = std::max(largest, end.norm() * step_rad / std::max(incidence, 1e-3));
  }
  return largest;
}

// The piece of a segment within the slice about a height; nothing where it has none.
std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>> InSlice(
    const Eigen::Vector3d& start, const Eigen::Vector3d& end, double height_m) {
  const double rise = end.z() - start.z();
  double first = 0.0;  // shares of the segment
  double last = 1.0;
  if (std::abs(rise) > 1e-9) {
    const double to_bottom = (height_m - kHalfSlice - start.z()) / rise;
    const double to_top = (height_m + kHalfSlice - start.z()) / rise;
    first = std::max(first, std::min(to_bottom, to_top));
    last = std::min(last, std::max(to_bottom, to_top));
  } else if (std::abs(start.z() - height_m) > kHalfSlice) {
    return std::nullopt;
  }
  if (first >= last) return std::nullopt;
  const Eigen::Vector3d along = end - start;
  return std::make_pair(Eigen::Vector2d((start + first * along).head<2>()),
                        Eigen::Vector2d((start + last * along).head<2>()));
}

// The spot that a point on a wall, seen from above, belongs to, and the spot's number along
// the wall.
template <typename Plane>
std::pair<int, WallSpot> SpotOn(const Plane&,
                                const Landmark& wall,
                                const Eigen::Vector2d& p,
                                double spacing_m) {
  const Eigen::Vector2d normal = wall.Normal().head<2>();
  const Eigen::Vector2d along(-normal.y(), normal.x());
  const int place = static_cast<int>(std::floor(along.dot(p) / spacing_m));
  return {place,
          WallSpot{(place + 0.5) * spacing_m * along + wall.Distance() * normal, normal}};
}
std::pair<int, WallSpot> SpotOn(const Cylinder&,
                                const Landmark& wall,
                                const Eigen::Vector2d& p,
                                double spacing_m) {
  const Eigen::Vector3d p_world(p.x(), p.y(), wall.extent.axes().anchor.z());
  const double u = wall.extent.Project(p_world).x();
  const Eigen::Vector4d plane = wall.PlaneNear(p_world);
  const Eigen::Vector2d normal = plane.head<2>().normalized();
  const double distance = wall.SignedDistance(p_world) / plane.head<2>().norm();
  return {static_cast<int>(std::floor(u / spacing_m)),
          WallSpot{p - distance * normal, normal}};
}

}  // namespace

PartView ViewFromAbove(const Rig& rig, const MapState& state, double spacing_m) {
  PartView view;
  std::set<std::pair<int, int>> seen;  // landmark, place along it
  SharedPoses shared(rig, state.trajectory);
  int num_on_walls = 0;
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id < 0 || observation.num_points == 0) continue;
    const Landmark& wall = state.landmarks[static_cast<size_t>(observation.landmark_id)];
    if (!TraitsOf(wall).bounds_floors) continue;
    if (LargestStep(observation) > spacing_m) continue;
    const ObservationPoses& poses = shared.Of(observation);
    const Eigen::Vector3d& scanner = poses.world_from_scanner.translation;
    const auto piece =
        InSlice(poses.motion.ToWorld(observation.start(), observation.start_time_ns()),
                poses.motion.ToWorld(observation.end(), observation.end_time_ns()),
                scanner.z());
    if (!piece) continue;
    const auto& [start, end] = *piece;
    const int num_steps = static_cast<int>((end - start).norm() / spacing_m) + 1;
    for (int step = 0; step <= num_steps; ++step) {
      const Eigen::Vector2d p = start + (end - start) * step / num_steps;
      const auto [place, spot] =
          VisitPlaneModel(wall.model, wall.chart, [&](const auto& kind) {
            return SpotOn(kind, wall, p, spacing_m);
          });
      if (seen.insert({wall.id, place}).second) view.spots.push_back(spot);
    }
    if (num_on_walls++ % kBeamStride == 0) {
      view.beams.push_back({scanner.head<2>(), 0.5 * (start + end)});
    }
  }
  return view;
}

}  // namespace plumbline
