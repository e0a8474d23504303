#pragma once

#include "core/map/imu_estimate.h"
#include "core/map/map_state.h"
#include "core/result/result_types.h"

namespace plumbline {

// Returns what has been found of the IMU, as users are told: what it is off the rig file by,
// the lean of gravity, and the biases in the course of the recording. state: has an IMU.
CalibratedImu DescribeImu(const MapState& state);

// Returns the rig file's IMU with pose and clock as they are estimated, and what is still
// uncertain of them: the largest standard deviations of their directions.
Imu ImuAsEstimated(const ImuEstimate& estimate);

}  // namespace plumbline
