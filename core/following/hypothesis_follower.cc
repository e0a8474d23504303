#include "core/following/hypothesis_follower.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/geometry/planar_pose.h"
#include "core/util/error.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// Time for which walls must have held one hypothesis before both are compared.
constexpr double kHeldTime = 0.5;  // s
// They go on side by side for no longer than this.
constexpr double kMaxTime = 4.0;  // s
// A motion contradicts the wheels if it is off by this number of standard deviations, of the
// wheels and of poses that no wall holds, and at least twice as far as that of the other
// hypothesis.
constexpr double kMaxWheelDeviation = 4.0;
constexpr double kHeadingStddev = 0.05;  // rad

// Returns the deviation of the motion between two instants from that of the wheels, in
// standard deviations; 0 where they say nothing.
double DeviationFromWheels(const MapState& state, int64_t begin_ns, int64_t end_ns) {
  if (state.odometry == nullptr) return 0.0;
  const std::optional<PlanarMotion> stated = state.odometry->Between(begin_ns, end_ns);
  if (!stated) return 0.0;
  const OdometryMeasurement wheels = state.odometry_calibration.Measure(*stated);
  const PlanarPose moved = FromAbove(state.trajectory.WorldFromBody(begin_ns)).Inverse() *
                           FromAbove(state.trajectory.WorldFromBody(end_ns));
  return std::hypot((moved.position - wheels.translation).norm() /
                        std::hypot(kUnheldStddev, wheels.translation_stddev),
                    std::remainder(moved.heading - wheels.turn, 2.0 * M_PI) /
                        std::hypot(kHeadingStddev, wheels.turn_stddev));
}

}  // namespace

HypothesisFollower::HypothesisFollower(const Rig& rig,
                                       bool planar,
                                       const MapperOptions& options,
                                       double scan_period_s,
                                       std::shared_ptr<const Odometry> odometry,
                                       std::shared_ptr<const ImuReadings> imu)
    : follower_(std::make_unique<ScanFollower>(
          rig, planar, options, scan_period_s, std::move(odometry), std::move(imu))),
      is_on_(options.rules.second_hypothesis) {}

void HypothesisFollower::Follow(const Scan& scan) {
  if (by_motion_ != nullptr) {
    FollowBoth(scan);
    if (by_motion_ != nullptr && IsDue(scan.end_ns)) Decide();
  } else {
    follower_->Follow(scan);
    if (!follower_->is_open()) {
      may_fork_ = true;
    } else if (is_on_ && may_fork_ && follower_->scan_matcher() != nullptr) {
      Fork(scan.end_ns);
    }
  }
  last_scan_ns_ = scan.end_ns;
}

void HypothesisFollower::Fork(int64_t now_ns) {
  may_fork_ = false;
  auto by_motion = std::make_unique<ScanFollower>(*follower_);
  try {
    by_motion->BridgeByMotion(now_ns);
  } catch (const Error&) {
    return;  // long walls and the motion do not determine the poses
  }
  by_motion_ = std::move(by_motion);
  place_ = std::make_unique<ScanMatcher>(*follower_->scan_matcher());
  sum_differences_ = sum_squared_differences_ = 0.0;
  held_ns_ = held_by_motion_ns_ = 0;
  forked_ns_ = now_ns;
}

void HypothesisFollower::FollowBoth(const Scan& scan) {
  try {
    by_motion_->Follow(scan);
  } catch (const LostTrack&) {
    GoOnWith(std::move(follower_));
    follower_->Follow(scan);
    return;
  }
  try {
    follower_->Follow(scan);
  } catch (const LostTrack&) {
    GoOnWith(std::move(by_motion_));
    return;
  }
  place_->Take(scan);
  const double difference = place_->NumInEmpty(follower_->state().trajectory) -
                            place_->NumInEmpty(by_motion_->state().trajectory);
  sum_differences_ += difference;
  sum_squared_differences_ += difference * difference;
  const int64_t duration_ns = scan.end_ns - last_scan_ns_;
  held_ns_ = follower_->is_open() ? 0 : held_ns_ + duration_ns;
  held_by_motion_ns_ = by_motion_->is_open() ? 0 : held_by_motion_ns_ + duration_ns;
}

bool HypothesisFollower::IsDue(int64_t now_ns) const {
  return SecondsBetween(0, std::max(held_ns_, held_by_motion_ns_)) >= kHeldTime ||
         SecondsBetween(forked_ns_, now_ns) >= kMaxTime;
}

void HypothesisFollower::Decide() {
  const double significance =
      sum_differences_ / std::sqrt(std::max(1.0, sum_squared_differences_));
  const double by_view_off =
      DeviationFromWheels(follower_->state(), forked_ns_, last_scan_ns_);
  const double by_motion_off =
      DeviationFromWheels(by_motion_->state(), forked_ns_, last_scan_ns_);
  const bool by_wheels = by_view_off > kMaxWheelDeviation && by_view_off > 2.0 * by_motion_off;
  const bool by_motion = by_wheels || significance > kSignificantStddevs;
  VLOG(1) << "two hypotheses from "
          << SecondsBetween(follower_->state().origin_time_ns, forked_ns_) << " s on; goes on "
          << (by_motion ? "by the motion" : "by what is in view") << ": " << sum_differences_
          << " points more in empty space, " << significance << " standard deviations; "
          << by_motion_off << " against " << by_view_off
          << " standard deviations off the wheels";
  GoOnWith(std::move(by_motion ? by_motion_ : follower_));
}

void HypothesisFollower::GoOnWith(std::unique_ptr<ScanFollower> follower) {
  follower_ = std::move(follower);
  follower_->EndBridging();
  by_motion_.reset();
  place_.reset();
}

}  // namespace plumbline
