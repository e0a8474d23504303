#include "core/map/map_state.h"

#include <algorithm>

namespace plumbline {
void CountObservation(const Observation& observation,
                      const ObservationPoses& poses,
                      MapState* state) {
  Landmark& landmark = state->landmarks[static_cast<size_t>(observation.landmark_id)];
  landmark.extent.AddSegment(
      poses.motion.ToWorld(observation.start(), observation.start_time_ns()),
      poses.motion.ToWorld(observation.end(), observation.end_time_ns()));
  if (landmark.num_segments == 0) {
    landmark.first_scan = observation.scan_index;
    landmark.first_time_ns = observation.start_time_ns();
  }
  landmark.last_scan = std::max(landmark.last_scan, observation.scan_index);
  landmark.last_time_ns = std::max(landmark.last_time_ns, observation.end_time_ns());
  ++landmark.num_segments;
  landmark.num_points += observation.num_points;
}

}  // namespace plumbline
