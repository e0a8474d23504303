#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/consistency/sightings.h"
#include "core/map/map_state.h"
#include "core/sensor/rig.h"

namespace plumbline {

// How far a scanner seems to sit, and its clock to go, off what the rig file says: the
// correction that would take all its segments, with or without a plane, best onto the planes
// that the other scanners see. Scanner frame. Directions that its segments leave open are zero.
struct MountingError {
  int num_segments = 0;  // that could be compared
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
  double time_offset_s = 0.0;
  double near_share = 0.0;   // of the segments, on those planes as they stand
  double moved_share = 0.0;  // after the correction
};

// One element for each scanner; without segments where there is no other scanner. The
// estimate has used the scanner as the rig file says and gives way to it, so that the errors
// are seen smaller than they are.
std::vector<MountingError> CompareMountings(const Rig& rig, bool planar, const MapState& state);

// "turned by 3.0 deg, shifted by 20 mm, its clock off by 12 ms": the parts that are large.
std::string MountingInWords(const MountingError& error);

}  // namespace plumbline
