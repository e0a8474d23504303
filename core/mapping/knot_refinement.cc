#include "core/mapping/knot_refinement.h"

#include <glog/logging.h>

#include <algorithm>

#include "core/geometry/angles.h"
#include "core/trajectory/motion_noise.h"
#include "core/trajectory/trajectory.h"

namespace plumbline {
namespace {

// Errors of the spline that a map is not to have, at any instant.
constexpr double kMaxRotation = 0.25 * kRadiansPerDegree;
constexpr double kMaxPosition = 0.01;  // m

}  // namespace

SplineError LargestSplineError(const MapState& state) {
  const Trajectory& trajectory = state.trajectory;
  const double of_accelerations =
      trajectory.knot_interval_s() * trajectory.knot_interval_s() / 32.0;
  SplineError largest;
  for (int i = 0; i + 3 < trajectory.num_control_points(); ++i) {
    // The interval between the second and the third of the four control points.
    const int64_t knot_ns = trajectory.start_ns() + i * trajectory.knot_interval_ns();
    if (!state.IsMapped(knot_ns - trajectory.knot_interval_ns()) ||
        !state.IsMapped(knot_ns + 2 * trajectory.knot_interval_ns())) {
      continue;
    }
    const KnotAcceleration before = KnotAcceleration::At(trajectory, i);
    const KnotAcceleration after = KnotAcceleration::At(trajectory, i + 1);
    largest.rotation_rad =
        std::max(largest.rotation_rad,
                 of_accelerations * (after.angular_body - before.angular_body).norm());
    largest.position_m =
        std::max(largest.position_m,
                 of_accelerations * (after.linear_world - before.linear_world).norm());
  }
  return largest;
}

bool RefineKnots(double min_scans_per_knot, double scan_period_s, MapState* state) {
  const double half_s = 0.5 * state->trajectory.knot_interval_s();
  const SplineError error = LargestSplineError(*state);
  VLOG(1) << "the motion leaves its spline by up to " << error.rotation_rad / kRadiansPerDegree
          << " deg, " << 1e3 * error.position_m << " mm";
  if (half_s < 0.999 * min_scans_per_knot * scan_period_s) return false;
  if (state->trajectory.knot_interval_ns() % 2 != 0) return false;
  if (error.rotation_rad < kMaxRotation && error.position_m < kMaxPosition) return false;
  LOG(INFO) << "knots every " << 1e3 * half_s << " ms: the motion leaves its spline by up to "
            << error.rotation_rad / kRadiansPerDegree << " deg, " << 1e3 * error.position_m
            << " mm";
  state->trajectory = state->trajectory.Refined();
  return true;
}

}  // namespace plumbline
