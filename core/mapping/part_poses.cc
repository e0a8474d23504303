#include "core/mapping/part_poses.h"

#include <cmath>
#include <set>
#include <utility>

#include "core/map/landmark_view.h"
#include "core/map/observation_poses.h"

namespace plumbline {
namespace {

// Of the segments on walls so many give a beam.
constexpr int kBeamStride = 20;

}  // namespace

PartView ViewFromAbove(const Rig& rig, const MapState& state, double spacing_m) {
  PartView view;
  std::set<std::pair<int, int>> seen;  // landmark, place along it
  SharedPoses shared(rig, state.trajectory);
  int num_on_walls = 0;
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id < 0 || observation.num_points == 0) continue;
    const Landmark& wall = state.landmarks[static_cast<size_t>(observation.landmark_id)];
    if (wall.model != PlaneModel::kVertical) continue;
    const ObservationPoses& poses = shared.Of(observation);
    const Eigen::Vector2d start =
        poses.motion.ToWorld(observation.start(), observation.start_time_ns()).head<2>();
    const Eigen::Vector2d end =
        poses.motion.ToWorld(observation.end(), observation.end_time_ns()).head<2>();
    const Eigen::Vector2d normal = wall.Normal().head<2>();
    const Eigen::Vector2d along(-normal.y(), normal.x());
    const int num_steps = static_cast<int>((end - start).norm() / spacing_m) + 1;
    for (int step = 0; step <= num_steps; ++step) {
      const Eigen::Vector2d p = start + (end - start) * step / num_steps;
      const int place = static_cast<int>(std::floor(along.dot(p) / spacing_m));
      if (!seen.insert({wall.id, place}).second) continue;
      view.spots.push_back(
          {(place + 0.5) * spacing_m * along + wall.Distance() * normal, normal});
    }
    if (num_on_walls++ % kBeamStride == 0) {
      view.beams.push_back(
          {poses.world_from_scanner.translation.head<2>(), 0.5 * (start + end)});
    }
  }
  return view;
}

}  // namespace plumbline
