#pragma once

#include <cstdint>
#include <deque>

#include "core/landmark.h"
#include "core/observation.h"
#include "core/observation_poses.h"
#include "core/trajectory.h"

namespace plumbline {

// Whitening of the origin's gauge constraint: far below any measured precision, yet well
// conditioned beside the residuals.
inline constexpr double kOriginSigma = 1e-5;  // m

// Everything the mapper estimates, in one place; tracker, window and batch work on it.
struct MapState {
  Trajectory trajectory;
  std::deque<Landmark> landmarks;        // position = id; merged ones stay, without segments
  std::deque<Observation> observations;  // by time
  int64_t origin_time_ns = 0;            // instant whose position is the model frame's origin
  // Beams of planes that no segment on them has: too few for one of their own, or parts of one
  // on no plane (core/segment_ends.h). With their landmarks; by scan line and beam.
  std::deque<Observation> short_runs = {};
};

// Takes an observation into its landmark's extent, times and counts. Observations come in
// the order of time, or near it.
void CountObservation(const Observation& observation,
                      const ObservationPoses& poses,
                      MapState* state);

}  // namespace plumbline
