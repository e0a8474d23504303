#include "core/estimation/odometry_terms.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

#include "core/estimation/estimation_problem.h"
#include "core/geometry/rigid3.h"
#include "factors/cost/odometry_factor.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

int64_t KnotTime(const Trajectory& trajectory, int knot) {
  return trajectory.start_ns() + knot * trajectory.knot_interval_ns();
}

std::optional<PlanarMotion> StatedMotion(const MapState& state, int interval) {
  return state.odometry->Between(KnotTime(state.trajectory, interval),
                                 KnotTime(state.trajectory, interval + 1));
}

}  // namespace

void AddOdometry(const MapState& state, int first, int end, EstimationProblem* problem) {
  if (state.odometry == nullptr) return;
  for (int interval = first; interval < end; ++interval) {
    const std::optional<PlanarMotion> stated = StatedMotion(state, interval);
    if (!stated) continue;
    problem->AddOdometry(interval, state.odometry_calibration.Measure(*stated));
  }
}

void Calibrate(const MapState& state, int first, int end, OdometryCalibration* calibration) {
  if (state.odometry == nullptr) return;
  const int num_intervals = state.trajectory.num_control_points() - kSplineOrder + 1;
  for (int interval = first; interval < std::min(end, num_intervals - 1); ++interval) {
    const int64_t begin_ns = KnotTime(state.trajectory, interval);
    const int64_t end_ns = KnotTime(state.trajectory, interval + 1);
    if (!state.IsMapped(begin_ns) || !state.IsMapped(end_ns)) continue;
    const std::optional<PlanarMotion> stated = StatedMotion(state, interval);
    if (!stated) continue;
    const Rigid3d begin = state.trajectory.WorldFromBody(begin_ns);
    const Rigid3d end_pose = state.trajectory.WorldFromBody(end_ns);
    const Eigen::Quaterniond begin_from_world = begin.rotation.conjugate();
    const Eigen::Quaterniond turn = begin_from_world * end_pose.rotation;
    PlanarMotion estimated;
    estimated.translation =
        (begin_from_world * (end_pose.translation - begin.translation)).head<2>();
    estimated.turn = Log(turn).z();
    calibration->Add(*stated, estimated);
  }
}

}  // namespace plumbline
