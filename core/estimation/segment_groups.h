#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/map/rig_calibration.h"
#include "core/sensor/rig.h"
#include "core/surface/landmark.h"
#include "core/trajectory/trajectory.h"
#include "factors/segment/linearised_group.h"
#include "factors/segment/segment_measurement.h"

namespace plumbline {

// Groups the observations that begin in one knot interval, or in a few, into one least squares
// term each (SegmentGroup), weighted for the poses and planes as they stand (WeightsOn). A
// group is kept from one problem to the next: it is made anew only where its observations,
// their landmarks or the loss have changed, and keeps its linearisation while that holds
// (LinearisedGroup).
class SegmentGroupCache {
 public:
  // The term over the control points first_control_point, + 1, ... and these landmarks.
  struct Entry {
    int first_control_point = 0;
    std::vector<int> landmark_ids;  // ascending; parallel to the group's planes
    std::shared_ptr<LinearisedGroup> group;
  };
  struct Loss {
    double huber_width = 0.0;     // see SegmentGroup
    bool landmarks_held = false;  // the groups' models are about the poses alone
  };

  // intervals_per_group: knot intervals of a group. Fewer and larger groups take less memory,
  // but only whole groups can be forgotten.
  SegmentGroupCache(const LinearisedGroup::Validity& validity, int intervals_per_group)
      : validity_(validity), intervals_per_group_(intervals_per_group) {}

  // Returns the groups of these observations, which have landmarks and outlive the groups.
  // Valid until the next call.
  // calibration: the scanners that the groups have blocks of; nullptr: none.
  std::vector<const Entry*> Update(const Rig& rig,
                                   const RigCalibration* calibration,
                                   const Trajectory& trajectory,
                                   const std::deque<Landmark>& landmarks,
                                   const std::vector<const Observation*>& observations,
                                   const Loss& loss);

  // Sets how far a linearisation holds, from the next Update() on.
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

// Returns WeightsOn an observation's landmark.
SegmentWeights ObservationWeights(const ObservationPoses& poses,
                                  const std::deque<Landmark>& landmarks,
                                  const Observation& observation);

}  // namespace plumbline
