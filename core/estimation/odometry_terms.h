#pragma once

#include "core/map/map_state.h"
#include "core/trajectory/odometry_calibration.h"

namespace plumbline {

class EstimationProblem;

// Adds what the wheels say of the knot intervals first .. end - 1 (each has the number of its
// first control point), as far as there is odometry and it covers them.
void AddOdometry(const MapState& state, int first, int end, EstimationProblem* problem);

// Takes the knot intervals first .. end - 1 of the trajectory into a calibration. None that
// lies in a gap of the map, or ends where the trajectory does.
void Calibrate(const MapState& state, int first, int end, OdometryCalibration* calibration);

}  // namespace plumbline
