#pragma once

#include "core/map/map_state.h"

namespace plumbline {

// How far a motion may be from the best spline of its knots, as the spline itself tells.
struct SplineError {
  double rotation_rad = 0.0;
  double position_m = 0.0;
};

// The largest error of the spline where the recording is mapped. The cubic that fits a motion
// best between knots stays up to 1/32 of the third difference of the control points away from
// one whose acceleration changes at once.
SplineError LargestSplineError(const MapState& state);

// Halves the knot interval where the motion asks for it: where at some instant it is a quarter
// degree or a centimetre from what the spline can follow, and as long as a knot interval holds
// min_scans_per_knot scans. Returns whether it has.
bool RefineKnots(double min_scans_per_knot, double scan_period_s, MapState* state);

}  // namespace plumbline
