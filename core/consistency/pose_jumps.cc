#include "core/consistency/pose_jumps.h"

#include <algorithm>
#include <cmath>

#include "core/util/time.h"

namespace plumbline {
namespace {

// A jump accelerates so many times as far as the largest tenth of the recording's seconds.
constexpr double kTimesUsual = 6.0;
constexpr double kUsualShare = 0.9;
// So many times where this share of at least so many places is contradicted as well.
constexpr double kTimesUsualWithPassages = 2.0;
constexpr double kPassages = 0.05;
constexpr double kMinPlaces = 40.0;
// And at least so far: 10 cm within a knot interval of an eighth of a second are 6 m/s^2, what
// a person carrying a rig reaches at a jolt.
constexpr double kMinAcceleration = 6.0;          // m/s^2
constexpr double kMinAngularAcceleration = 20.0;  // rad/s^2

// Floors and ceilings are wider than this both ways, treads are not.
constexpr double kMaxTread = 1.0;  // m
// The height jumps by so many times what the largest tenth of the seconds shows, and by so
// much: a person on stairs reaches 3 m/s^2, a slip by a tread 4 to 8.
constexpr double kTimesUsualHeight = 1.7;
constexpr double kMinVerticalAcceleration = 4.0;  // m/s^2

// A glitch: the share of points on planes falls to so much of its median over kNeighbours
// intervals before and after, and the acceleration is so many times the usual.
constexpr double kGlitchSupport = 0.85;
constexpr int kNeighbours = 8;
constexpr double kGlitchTimesUsual = 1.5;
constexpr double kMinPoints = 100.0;  // in an interval

// The value below which a share of them lies.
double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(
      values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

}  // namespace

std::vector<SecondOfMotion> MotionOverTime(const Trajectory& trajectory, int64_t start_ns) {
  std::vector<SecondOfMotion> seconds;
  Eigen::Vector3d previous_angular = Eigen::Vector3d::Zero();
  Eigen::Vector3d previous_linear = Eigen::Vector3d::Zero();
  bool has_previous = false;
  const int64_t step_ns = trajectory.knot_interval_ns();
  const double step_s = trajectory.knot_interval_s();
  for (int64_t at_ns = trajectory.start_ns(); at_ns < trajectory.end_ns(); at_ns += step_ns) {
    Eigen::Vector3d angular;
    Eigen::Vector3d linear;
    trajectory.Velocity(at_ns, &angular, &linear);
    const double since_s = SecondsBetween(start_ns, at_ns);
    const auto second = static_cast<size_t>(std::max(0.0, std::floor(since_s)));
    if (second >= seconds.size()) seconds.resize(second + 1);
    SecondOfMotion& now = seconds[second];
    now.speed_m_s = std::max(now.speed_m_s, linear.norm());
    if (has_previous) {
      now.acceleration_m_s2 =
          std::max(now.acceleration_m_s2, (linear - previous_linear).norm() / step_s);
      now.vertical_acceleration_m_s2 = std::max(
          now.vertical_acceleration_m_s2, std::abs(linear.z() - previous_linear.z()) / step_s);
      now.angular_acceleration_rad_s2 = std::max(now.angular_acceleration_rad_s2,
                                                 (angular - previous_angular).norm() / step_s);
    }
    previous_angular = angular;
    previous_linear = linear;
    has_previous = true;
  }
  return seconds;
}

SharesOverTime SupportOverTime(const MapState& state, int64_t start_ns) {
  SharesOverTime shares;
  for (const Observation& observation : state.observations) {
    const double since_s = SecondsBetween(start_ns, observation.middle_time_ns());
    const auto at = static_cast<size_t>(std::max(0.0, since_s) / kSupportStep);
    if (at >= shares.size()) shares.resize(at + 1);
    shares[at].comparable += observation.num_points;
    if (observation.landmark_id < 0) shares[at].contradicted += observation.num_points;
  }
  return shares;
}

std::vector<bool> FindGlitches(const std::vector<SecondOfMotion>& motion,
                               const SharesOverTime& support) {
  std::vector<double> accelerations;
  std::vector<double> angular;
  for (const SecondOfMotion& second : motion) {
    accelerations.push_back(second.acceleration_m_s2);
    angular.push_back(second.angular_acceleration_rad_s2);
  }
  const double limit = kGlitchTimesUsual * Quantile(accelerations, kUsualShare);
  const double angular_limit = kGlitchTimesUsual * Quantile(angular, kUsualShare);
  std::vector<bool> is_glitch(motion.size(), false);
  const auto size = static_cast<int>(support.size());
  for (int i = 0; i < size; ++i) {
    const auto second = static_cast<size_t>(i * kSupportStep);
    if (second >= motion.size() || support[static_cast<size_t>(i)].comparable < kMinPoints) {
      continue;
    }
    const bool is_hard = motion[second].acceleration_m_s2 > limit ||
                         motion[second].angular_acceleration_rad_s2 > angular_limit;
    if (!is_hard) continue;
    std::vector<double> near;
    for (int j = std::max(0, i - kNeighbours); j < std::min(size, i + kNeighbours + 1); ++j) {
      near.push_back(1.0 - support[static_cast<size_t>(j)].value());
    }
    const double usual = Quantile(near, 0.5);
    if (1.0 - support[static_cast<size_t>(i)].value() < kGlitchSupport * usual) {
      is_glitch[second] = true;
    }
  }
  return is_glitch;
}

std::vector<bool> FindJumps(const std::vector<SecondOfMotion>& motion,
                            const SharesOverTime& passages) {
  std::vector<double> accelerations;
  std::vector<double> angular;
  for (const SecondOfMotion& second : motion) {
    accelerations.push_back(second.acceleration_m_s2);
    angular.push_back(second.angular_acceleration_rad_s2);
  }
  const double usual = Quantile(accelerations, kUsualShare);
  const double usual_angular = Quantile(angular, kUsualShare);
  std::vector<bool> is_jump;
  for (size_t s = 0; s < motion.size(); ++s) {
    const bool passes = s < passages.size() && passages[s].comparable >= kMinPlaces &&
                        passages[s].value() > kPassages;
    const double times_usual = passes ? kTimesUsualWithPassages : kTimesUsual;
    is_jump.push_back(motion[s].acceleration_m_s2 >
                          std::max(kMinAcceleration, times_usual * usual) ||
                      motion[s].angular_acceleration_rad_s2 >
                          std::max(kMinAngularAcceleration, times_usual * usual_angular));
  }
  return is_jump;
}

std::vector<bool> HeightHangsOnTreads(const MapState& state, int64_t start_ns) {
  std::vector<bool> is_seen;   // by interval: anything
  std::vector<bool> is_known;  // by interval: a floor or ceiling
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id < 0) continue;
    const double since_s = SecondsBetween(start_ns, observation.middle_time_ns());
    const auto at = static_cast<size_t>(std::max(0.0, since_s) / kSupportStep);
    if (at >= is_seen.size()) {
      is_seen.resize(at + 1, false);
      is_known.resize(at + 1, false);
    }
    is_seen[at] = true;
    const Landmark& landmark = state.landmarks[static_cast<size_t>(observation.landmark_id)];
    if (landmark.model != PlaneModel::kHorizontal) continue;
    const Eigen::Vector2d size = landmark.extent.max_corner() - landmark.extent.min_corner();
    if (size.minCoeff() > kMaxTread) is_known[at] = true;
  }
  std::vector<bool> hangs;
  for (size_t at = 0; at < is_seen.size(); ++at) {
    const auto second = static_cast<size_t>(static_cast<double>(at) * kSupportStep);
    if (second >= hangs.size()) hangs.resize(second + 1, false);
    if (is_seen[at] && !is_known[at]) hangs[second] = true;
  }
  return hangs;
}

std::vector<bool> FindHeightJumps(const std::vector<SecondOfMotion>& motion,
                                  const std::vector<bool>& hangs_on_treads) {
  std::vector<double> accelerations;
  for (const SecondOfMotion& second : motion) {
    accelerations.push_back(second.vertical_acceleration_m_s2);
  }
  const double limit = std::max(kMinVerticalAcceleration,
                                kTimesUsualHeight * Quantile(accelerations, kUsualShare));
  std::vector<bool> is_jump(motion.size(), false);
  for (size_t s = 0; s < motion.size(); ++s) {
    // A slip that begins where treads are all may end in the next second, and the reverse.
    const size_t end = std::min(hangs_on_treads.size(), s + 2);
    const bool hangs =
        std::any_of(hangs_on_treads.begin() +
                        static_cast<std::ptrdiff_t>(std::min(end, s > 0 ? s - 1 : 0)),
                    hangs_on_treads.begin() + static_cast<std::ptrdiff_t>(end),
                    [](bool hangs_then) { return hangs_then; });
    is_jump[s] = hangs && accelerations[s] > limit;
  }
  return is_jump;
}

}  // namespace plumbline
