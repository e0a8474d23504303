#pragma once

#include <cstdint>
#include <deque>

#include "core/map/landmark.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/trajectory/trajectory.h"

namespace plumbline {

// Everything the mapper estimates, in one place; tracker, window and batch work on it.
struct MapState {
  Trajectory trajectory;
  std::deque<Landmark> landmarks;        // position = id; merged ones stay, without segments
  std::deque<Observation> observations;  // by time
  int64_t origin_time_ns = 0;            // instant whose position is the model frame's origin
  // Beams of planes that no segment on them has: too few for one of their own, or parts of one
  // on no plane (core/visibility/resegmentation.h). With their landmarks; by scan line and
  // beam.
  std::deque<Observation> sub_minimum_segments = {};
};

// Takes an observation into its landmark's extent, times and counts. Observations come in
// the order of time, or near it.
void CountObservation(const Observation& observation,
                      const ObservationPoses& poses,
                      MapState* state);

}  // namespace plumbline
