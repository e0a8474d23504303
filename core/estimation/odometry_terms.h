#pragma once

#include "core/map/map_state.h"
#include "core/trajectory/odometry_calibration.h"

namespace plumbline {

class EstimationProblem;

// Adds what the wheels say of the stretches that begin in the knot intervals first .. end - 1
// (each has the number of its first control point), as far as there is odometry and it covers
// them. A stretch lasts from the first sample in an interval to the first one in a later
// interval: the pose between samples is not known but by the pace of others. Where samples are
// further apart than a term may reach, it lasts from knot to knot, at an even pace. The last
// one ends with the trajectory.
void AddOdometry(const MapState& state, int first, int end, EstimationProblem* problem);

// Adds the same from knot to knot, for a prediction up to the end of the trajectory.
void AddOdometryByKnots(const MapState& state, int first, int end, EstimationProblem* problem);

// Takes the stretches that begin in the knot intervals first .. end - 1 into a calibration.
// None that lies in a gap of the map, or ends where the trajectory does.
void Calibrate(const MapState& state, int first, int end, OdometryCalibration* calibration);

}  // namespace plumbline
