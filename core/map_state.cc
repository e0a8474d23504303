#include "core/map_state.h"

#include <algorithm>

namespace plumbline {
namespace {

Eigen::Vector3d Lift(const Eigen::Vector2d& p) { return {p.x(), p.y(), 0.0}; }

}  // namespace

void CountObservation(const Rig& rig, const Observation& observation, MapState* state) {
  Landmark& landmark = state->landmarks[static_cast<size_t>(observation.landmark_id)];
  const Rigid3d& body_from_scanner =
      rig.scanners[static_cast<size_t>(observation.scanner_index)].body_from_scanner;
  const Rigid3d start =
      state->trajectory.WorldFromBody(observation.start_time_ns) * body_from_scanner;
  const Rigid3d end =
      state->trajectory.WorldFromBody(observation.end_time_ns) * body_from_scanner;
  landmark.extent.AddSegment(start * Lift(observation.start), end * Lift(observation.end));
  if (landmark.num_segments == 0) {
    landmark.first_scan = observation.scan_index;
    landmark.first_time_ns = observation.start_time_ns;
  }
  landmark.last_scan = std::max(landmark.last_scan, observation.scan_index);
  landmark.last_time_ns = std::max(landmark.last_time_ns, observation.end_time_ns);
  ++landmark.num_segments;
  landmark.num_points += observation.num_points;
}

}  // namespace plumbline
