#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/map/map_state.h"

namespace plumbline {

// ImuContradiction is a second about which the IMU, as it is estimated, has read another
// motion than the map's: in the second itself and its two neighbours.
struct ImuContradiction {
  int second = 0;
  bool by_accelerometer = false;  // otherwise by the gyroscope
  // Map minus readings, along the world's axes: change of velocity, m/s, or turn, rad.
  Eigen::Vector3d difference_world = Eigen::Vector3d::Zero();
};

// Finds the seconds, by sensor and time, in which the difference is no chance: its square in
// variances exceeds what one of all that are asked exceeds with the probability of
// kSignificantStddevs. The variance is that of the readings' white noise, or larger where
// the differences of most seconds are: what the rig file states of a noise may be too little.
// Single readings do not tell: where the spline can not follow them, a jolt or a level scanner
// that is carried up a ramp, they are taken for uncertain.
// num_seconds: from start_ns. Nothing without an IMU, or where the rig moves in the plane.
std::vector<ImuContradiction> FindImuContradictions(const MapState& state,
                                                    int num_seconds,
                                                    int64_t start_ns);

}  // namespace plumbline
