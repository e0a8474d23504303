#include "core/estimation/odometry_terms.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

#include "core/estimation/estimation_problem.h"
#include "core/geometry/rigid3.h"
#include "core/util/time.h"
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

// Whether the surfaces seen in an interval show how far the rig went along a direction, beside
// what wheels say with a standard deviation (m). Where they do not, as in a corridor without
// doors, the wheels alone have made the estimate, and would confirm themselves.
bool ScansShowWay(const MapState& state,
                  int64_t begin_ns,
                  int64_t end_ns,
                  const Eigen::Vector3d& direction_world,
                  double wheels_stddev) {
  constexpr double kMinShare = 0.1;             // of the wheels' information
  constexpr int64_t kUnorderedNs = 50'000'000;  // by which observations may be out of order
  const auto first = std::lower_bound(state.observations.begin(),
                                      state.observations.end(),
                                      begin_ns - kUnorderedNs,
                                      [](const Observation& observation, int64_t t) {
                                        return observation.start_time_ns() < t;
                                      });
  double information = 0.0;  // on the position, 1/m^2
  for (auto at = first;
       at != state.observations.end() && at->start_time_ns() < end_ns + kUnorderedNs;
       ++at) {
    if (at->landmark_id < 0 || at->start_time_ns() < begin_ns ||
        at->start_time_ns() >= end_ns) {
      continue;
    }
    const Landmark& landmark = state.landmarks[static_cast<size_t>(at->landmark_id)];
    const double along = landmark.Normal().dot(direction_world);
    const double sigma = at->sigma_offset_m;
    if (sigma > 0.0) information += along * along / (sigma * sigma);
  }
  // A way is the difference of two positions.
  return information / 2.0 > kMinShare / (wheels_stddev * wheels_stddev);
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
    const Eigen::Vector3d way = end_pose.translation - begin.translation;
    const Eigen::Quaterniond begin_from_world = begin.rotation.conjugate();
    const Eigen::Quaterniond turn = begin_from_world * end_pose.rotation;
    PlanarMotion estimated;
    estimated.translation = (begin_from_world * way).head<2>();
    estimated.turn = Log(turn).z();
    const double wheels_stddev = calibration->Measure(*stated).translation_stddev;
    calibration->Add(
        *stated,
        estimated,
        ScansShowWay(state, begin_ns, end_ns, way.normalized(), wheels_stddev));
  }
}

}  // namespace plumbline
