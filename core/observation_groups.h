#pragma once

#include <deque>
#include <vector>

#include "core/landmark.h"
#include "core/observation.h"
#include "core/rig.h"
#include "core/trajectory.h"
#include "factors/segment_group.h"

namespace plumbline {

// The observations that begin in one knot interval, as one least squares term over the control
// points first_control_point, +1, ... and these landmarks.
struct ObservationGroup {
  int first_control_point = 0;
  std::vector<int> landmark_ids;  // parallel to group.planes(), ascending
  SegmentGroup group;
};

// Groups observations that have a landmark, weighted for the poses and planes as they stand
// (WeightsOn). huber_width: see SegmentGroup. The observations outlive the groups.
std::vector<ObservationGroup> GroupObservations(
    const Rig& rig,
    const Trajectory& trajectory,
    const std::deque<Landmark>& landmarks,
    const std::vector<const Observation*>& observations,
    double huber_width);

// WeightsOn an observation's landmark.
SegmentWeights ObservationWeights(const Rig& rig,
                                  const Trajectory& trajectory,
                                  const std::deque<Landmark>& landmarks,
                                  const Observation& observation);

}  // namespace plumbline
