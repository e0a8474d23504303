#include "core/judging/pose_jumps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/judging/degeneracy.h"
#include "core/judging/verdict_levels.h"
#include "core/surface/landmark_view.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

using Kinds = std::array<double, SecondOfMotion::kNumKinds>;

// What is usual is what all but the hardest tenth of the seconds show, for each kind by
// itself.
constexpr double kUsualShare = 0.9;
// An acceleration is a jump if it is kTimesUsual times the usual one and above kMinJump: 10 cm
// within an eighth of a second are 6 m/s^2, what a person carrying a rig reaches at a jolt.
constexpr double kTimesUsual = 3.0;
constexpr Kinds kMinJump = {6.0, 6.0, 20.0, 6.0};
// A rig that hardly ever rises or tilts jumps with less, twice as far beyond the usual.
constexpr Kinds kMinFarJump = {6.0, 1.0, 20.0, 1.0};
// At the ends of what is mapped the scans of one side alone determine the spline.
constexpr int64_t kNumEndKnots = 2;
// Multiple of the usual acceleration where also places are contradicted.
constexpr double kTimesUsualWithPassages = 2.0;

// A direction is unobservable if its standard deviation from wide surfaces is this multiple of
// the usual one.
constexpr double kTimesUsualStddev = 4.0;
constexpr double kMinStddev = 0.003;  // m
// What hardly any rig does while nothing shows it; a person on stairs reaches 3 m/s^2 in
// height, a slip by a tread 4 to 8, one along a corridor 3 to 13.
constexpr double kMinHorizontal = 2.5;  // m/s^2
constexpr double kMinVertical = 4.0;    // m/s^2

// A glitch: the share of points on planes falls below kGlitchSupport of its median over
// kNeighbours intervals before and after, and the acceleration is kGlitchTimesUsual times the
// usual one.
constexpr double kGlitchSupport = 0.85;
constexpr double kGlitchTimesUsual = 1.5;
constexpr Kinds kMinGlitch = {3.5, 1.0, 15.0, 0.5};
constexpr int kNeighbours = 8;
constexpr double kMinPoints = 100.0;  // in an interval

Kinds Usual(const std::vector<SecondOfMotion>& motion) {
  Kinds usual;
  for (size_t k = 0; k < usual.size(); ++k) {
    std::vector<double> accelerations;
    for (const SecondOfMotion& second : motion) {
      accelerations.push_back(second.accelerations[k]);
    }
    usual[k] = SampleQuantile(std::move(accelerations), kUsualShare);
  }
  return usual;
}

// Returns whether an acceleration exceeds times_usual times the usual one of its kind, and the
// minimum.
bool Exceeds(const SecondOfMotion& second,
             const Kinds& usual,
             double times_usual,
             const Kinds& minimum) {
  for (size_t k = 0; k < usual.size(); ++k) {
    if (second.accelerations[k] > std::max(minimum[k], times_usual * usual[k])) return true;
  }
  return false;
}

// The mean angular and linear accelerations before a knot, rad/s^2 and m/s^2, world frame.
std::pair<Eigen::Vector3d, Eigen::Vector3d> AccelerationsAt(const Trajectory& trajectory,
                                                            int64_t knot_ns) {
  Eigen::Vector3d angular_before;
  Eigen::Vector3d linear_before;
  Eigen::Vector3d angular;
  Eigen::Vector3d linear;
  const double span_s = std::max(kSlipTime, trajectory.knot_interval_s());
  const int64_t before_ns =
      std::max(trajectory.start_ns(), knot_ns - NanosecondsFromSeconds(span_s));
  trajectory.Velocity(before_ns, &angular_before, &linear_before);
  trajectory.Velocity(knot_ns, &angular, &linear);
  return {(angular - angular_before) / span_s, (linear - linear_before) / span_s};
}

// Whether the interval before a knot lies well within what is mapped.
bool IsJudged(const MapState& state, int64_t knot_ns) {
  const int64_t step_ns = state.trajectory.knot_interval_ns();
  return state.IsMapped(knot_ns - (1 + kNumEndKnots) * step_ns) &&
         state.IsMapped(knot_ns + kNumEndKnots * step_ns);
}

// How the trajectory accelerates at a knot, and how well wide surfaces alone, turns being
// known, show in the scans of the interval before it where the rig is: information, 1/m^2.
struct SupportedAcceleration {
  int64_t time_ns = 0;
  Eigen::Vector3d world_m_s2 = Eigen::Vector3d::Zero();
  double information = 0.0;        // in the direction of the acceleration
  double usual_information = 0.0;  // the mean of three directions
};

// Accelerations of all knots before which scans were taken.
std::vector<SupportedAcceleration> SupportedAccelerations(const Rig& rig,
                                                          const MapState& state) {
  std::vector<LandmarkView> planes;
  for (const Landmark& landmark : state.landmarks) planes.emplace_back(landmark);
  SharedPoses poses(rig, state.trajectory);
  const Trajectory& trajectory = state.trajectory;
  const int64_t step_ns = trajectory.knot_interval_ns();
  std::vector<SupportedAcceleration> accelerations;
  size_t next = 0;  // the observations are in the order of time
  for (int64_t at_ns = trajectory.start_ns() + step_ns; at_ns < trajectory.end_ns();
       at_ns += step_ns) {
    SupportedAcceleration a;
    a.time_ns = at_ns;
    a.world_m_s2 = AccelerationsAt(trajectory, at_ns).second;
    const Eigen::Vector3d direction = a.world_m_s2.normalized();
    const size_t first = next;
    for (; next < state.observations.size(); ++next) {
      const Observation& observation = state.observations[next];
      if (observation.middle_time_ns() >= at_ns) break;
      if (observation.landmark_id < 0) continue;
      const auto id = static_cast<size_t>(observation.landmark_id);
      if (!IsWide(state.landmarks[id])) continue;
      const double stddev_m = DistanceStddev(observation, poses.Of(observation), planes[id]);
      if (stddev_m <= 0.0) continue;
      const double information = 1.0 / (stddev_m * stddev_m);
      const Eigen::Vector3d centroid =
          poses.Of(observation).motion.nodes()[1] * observation.centroid().homogeneous();
      const double along = planes[id].UnitNormalNear(centroid).dot(direction);
      a.information += along * along * information;
      a.usual_information += information / 3.0;
    }
    if (next > first && IsJudged(state, at_ns)) accelerations.push_back(a);
  }
  return accelerations;
}

}  // namespace

std::vector<SecondOfMotion> MotionOverTime(const MapState& state, int64_t start_ns) {
  const Trajectory& trajectory = state.trajectory;
  std::vector<SecondOfMotion> seconds;
  const int64_t step_ns = trajectory.knot_interval_ns();
  for (int64_t at_ns = trajectory.start_ns() + step_ns; at_ns < trajectory.end_ns();
       at_ns += step_ns) {
    const double since_s = SecondsBetween(start_ns, at_ns);
    const auto second = static_cast<size_t>(std::max(0.0, std::floor(since_s)));
    if (second >= seconds.size()) seconds.resize(second + 1);
    if (!IsJudged(state, at_ns)) continue;
    const auto [turning, moving] = AccelerationsAt(trajectory, at_ns);
    const Kinds now = {moving.head<2>().norm(),
                       std::abs(moving.z()),
                       std::abs(turning.z()),
                       turning.head<2>().norm()};
    for (size_t k = 0; k < now.size(); ++k) {
      seconds[second].accelerations[k] = std::max(seconds[second].accelerations[k], now[k]);
    }
  }
  return seconds;
}

SharesOverTime SupportOverTime(const MapState& state, int64_t start_ns) {
  SharesOverTime shares;
  for (const Observation& observation : state.observations) {
    const double since_s = SecondsBetween(start_ns, observation.middle_time_ns());
    const auto at = static_cast<size_t>(std::max(0.0, since_s) / kSlipTime);
    if (at >= shares.size()) shares.resize(at + 1);
    shares[at].comparable += observation.num_points;
    if (observation.landmark_id < 0) shares[at].contradicted += observation.num_points;
  }
  return shares;
}

std::vector<bool> FindGlitches(const std::vector<SecondOfMotion>& motion,
                               const SharesOverTime& support) {
  const Kinds usual = Usual(motion);
  std::vector<bool> is_glitch(motion.size(), false);
  const auto size = static_cast<int>(support.size());
  for (int i = 0; i < size; ++i) {
    const auto second = static_cast<size_t>(i * kSlipTime);
    if (second >= motion.size() || support[static_cast<size_t>(i)].comparable < kMinPoints) {
      continue;
    }
    if (!Exceeds(motion[second], usual, kGlitchTimesUsual, kMinGlitch)) continue;
    std::vector<double> near;
    for (int j = std::max(0, i - kNeighbours); j < std::min(size, i + kNeighbours + 1); ++j) {
      near.push_back(1.0 - support[static_cast<size_t>(j)].value());
    }
    const double usual_support = Median(near);
    if (1.0 - support[static_cast<size_t>(i)].value() < kGlitchSupport * usual_support) {
      is_glitch[second] = true;
    }
  }
  return is_glitch;
}

std::vector<bool> FindJumps(const std::vector<SecondOfMotion>& motion,
                            const SharesOverTime& passages) {
  const Kinds usual = Usual(motion);
  std::vector<bool> is_jump;
  for (size_t s = 0; s < motion.size(); ++s) {
    const bool passes = s < passages.size() && passages[s].comparable >= kMinComparable &&
                        passages[s].value() > kHardlyAnyShare;
    const double times_usual = passes ? kTimesUsualWithPassages : kTimesUsual;
    is_jump.push_back(Exceeds(motion[s], usual, times_usual, kMinJump) ||
                      Exceeds(motion[s], usual, 2.0 * kTimesUsual, kMinFarJump));
  }
  return is_jump;
}

std::vector<bool> FindUnsupportedJumps(const Rig& rig,
                                       const MapState& state,
                                       const std::vector<SecondOfMotion>& motion,
                                       int64_t start_ns) {
  const std::vector<SupportedAcceleration> accelerations = SupportedAccelerations(rig, state);
  std::vector<double> usual;
  for (const SupportedAcceleration& a : accelerations) usual.push_back(a.usual_information);
  const double min_information =
      std::min(Median(usual) / (kTimesUsualStddev * kTimesUsualStddev),
               1.0 / (kMinStddev * kMinStddev));
  // A rig that takes every turn hard does so past a doorway, too.
  const Kinds usual_acceleration = Usual(motion);
  const double min_horizontal =
      std::max(kMinHorizontal, usual_acceleration[SecondOfMotion::kHorizontal]);
  const double min_vertical =
      std::max(kMinVertical, usual_acceleration[SecondOfMotion::kVertical]);
  std::vector<bool> is_jump;
  for (const SupportedAcceleration& a : accelerations) {
    const auto second =
        static_cast<size_t>(std::max(0.0, SecondsBetween(start_ns, a.time_ns)));
    if (second >= is_jump.size()) is_jump.resize(second + 1, false);
    const double times = std::hypot(a.world_m_s2.head<2>().norm() / min_horizontal,
                                    a.world_m_s2.z() / min_vertical);
    if (a.information < min_information && times > 1.0) is_jump[second] = true;
  }
  return is_jump;
}

}  // namespace plumbline
