#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "core/map/landmark.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/sensor/rig.h"
#include "core/trajectory/trajectory.h"
#include "factors/segment/linearised_group.h"
#include "factors/segment/segment_measurement.h"

namespace plumbline {

// The observations that begin in one knot interval, or in a few, as one least squares term
// over the control points first_control_point, +1, ... and these landmarks.
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

// The same, kept from one problem to the next: only groups whose observations, landmarks or
// loss have changed are made anew; the others keep their linearisation while it holds
// (LinearisedGroup).
class ObservationGroupCache {
 public:
  struct Entry {
    int first_control_point = 0;
    std::vector<int> landmark_ids;  // ascending
    std::shared_ptr<LinearisedGroup> group;
  };

  // Groups of this many knot intervals: fewer and larger ones take less memory, but
  // only whole groups can be forgotten.
  ObservationGroupCache(const LinearisedGroup::Validity& validity, int intervals_per_group)
      : validity_(validity), intervals_per_group_(intervals_per_group) {}

  // Groups of all these observations; valid until the next call.
  std::vector<const Entry*> Update(const Rig& rig,
                                   const Trajectory& trajectory,
                                   const std::deque<Landmark>& landmarks,
                                   const std::vector<const Observation*>& observations,
                                   double huber_width);

  // From the next Update() on.
  void set_validity(const LinearisedGroup::Validity& validity) { validity_ = validity; }

  // Drops the groups that begin before this control point.
  void ForgetBefore(int control_point);

 private:
  struct Kept {
    Entry entry;
    uint64_t fingerprint = 0;  // of its observations
    double huber_width = 0.0;
  };

  LinearisedGroup::Validity validity_;
  int intervals_per_group_;
  std::map<int, Kept> groups_;  // by first control point
};

// WeightsOn an observation's landmark.
SegmentWeights ObservationWeights(const ObservationPoses& poses,
                                  const std::deque<Landmark>& landmarks,
                                  const Observation& observation);

}  // namespace plumbline
