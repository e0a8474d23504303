#include "core/estimation/odometry_terms.h"

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "core/estimation/estimation_problem.h"
#include "core/estimation/linearisation.h"
#include "core/geometry/rigid3.h"
#include "factors/cost/odometry_factor.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

int64_t KnotTime(const Trajectory& trajectory, int knot) {
  return trajectory.start_ns() + knot * trajectory.knot_interval_ns();
}

int IntervalOf(const Trajectory& trajectory, int64_t time_ns) {
  return static_cast<int>(std::floor(static_cast<double>(time_ns - trajectory.start_ns()) /
                                     static_cast<double>(trajectory.knot_interval_ns())));
}

// The instant in a knot interval at which a stretch ends and the next one begins.
std::optional<int64_t> StationIn(const MapState& state, int interval) {
  const Trajectory& trajectory = state.trajectory;
  const int64_t knot_ns = KnotTime(trajectory, interval);
  const std::optional<int64_t> after_ns = state.odometry->SampleFrom(knot_ns);
  if (!after_ns || *after_ns < KnotTime(trajectory, interval + 1)) return after_ns;
  const std::optional<int64_t> before_ns = state.odometry->SampleBefore(knot_ns);
  if (!before_ns) return std::nullopt;
  const int num_apart = IntervalOf(trajectory, *after_ns) - IntervalOf(trajectory, *before_ns);
  if (num_apart + kSplineOrder <= kTileControlPoints + 1) return std::nullopt;
  return knot_ns;
}

// Calls visit(begin_ns, end_ns) for each stretch that begins in first .. end - 1.
template <typename Visit>
void ForEachStretch(const MapState& state, int first, int end, const Visit& visit) {
  const int num_intervals = state.trajectory.num_control_points() - kSplineOrder + 1;
  std::optional<int64_t> begin_ns;
  for (int interval = first; interval < num_intervals; ++interval) {
    const std::optional<int64_t> station_ns = StationIn(state, interval);
    if (!station_ns) continue;
    if (begin_ns) visit(*begin_ns, *station_ns);
    if (interval >= end) return;
    begin_ns = station_ns;
  }
  if (begin_ns) visit(*begin_ns, state.trajectory.end_ns());
}

void AddMotion(const MapState& state,
               int64_t begin_ns,
               int64_t end_ns,
               EstimationProblem* problem) {
  const std::optional<PlanarMotion> stated = state.odometry->Between(begin_ns, end_ns);
  if (!stated) return;
  problem->AddOdometry(begin_ns, end_ns, state.odometry_calibration.Measure(*stated));
}

}  // namespace

void AddOdometry(const MapState& state, int first, int end, EstimationProblem* problem) {
  if (state.odometry == nullptr) return;
  ForEachStretch(state, first, end, [&](int64_t begin_ns, int64_t end_ns) {
    AddMotion(state, begin_ns, end_ns, problem);
  });
}

void AddOdometryByKnots(const MapState& state,
                        int first,
                        int end,
                        EstimationProblem* problem) {
  if (state.odometry == nullptr) return;
  for (int interval = first; interval < end; ++interval) {
    AddMotion(state,
              KnotTime(state.trajectory, interval),
              KnotTime(state.trajectory, interval + 1),
              problem);
  }
}

void Calibrate(const MapState& state, int first, int end, OdometryCalibration* calibration) {
  if (state.odometry == nullptr) return;
  ForEachStretch(state, first, end, [&](int64_t begin_ns, int64_t end_ns) {
    if (end_ns >= state.trajectory.end_ns()) return;
    if (!state.IsMapped(begin_ns) || !state.IsMapped(end_ns)) return;
    const std::optional<PlanarMotion> stated = state.odometry->Between(begin_ns, end_ns);
    if (!stated) return;
    const Rigid3d begin = state.trajectory.WorldFromBody(begin_ns);
    const Rigid3d end_pose = state.trajectory.WorldFromBody(end_ns);
    const Eigen::Quaterniond begin_from_world = begin.rotation.conjugate();
    const Eigen::Quaterniond turn = begin_from_world * end_pose.rotation;
    PlanarMotion estimated;
    estimated.translation =
        (begin_from_world * (end_pose.translation - begin.translation)).head<2>();
    estimated.turn = Log(turn).z();
    calibration->Add(*stated, estimated);
  });
}

}  // namespace plumbline
