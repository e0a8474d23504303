#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "core/following/scan_follower.h"
#include "core/options/mapper_options.h"
#include "core/registration/scan_matching.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_reader.h"

namespace plumbline {

// Follows the rig through weak moments by two hypotheses side by side. Where walls leave its
// position open in some direction, what little else is in view may show how far it goes, or
// may be somebody who walks along: one hypothesis believes it, the other leaves the direction
// to the predicted motion, each with its own covariance. When walls hold one of them again,
// the motion's goes on if by it significantly fewer points lie in space that was seen to be
// empty before the fork, or if the other one contradicts the wheels: among furniture, points
// that belong to something else may agree better than those that are right.
class HypothesisFollower {
 public:
  HypothesisFollower(const Rig& rig,
                     bool planar,
                     const MapperOptions& options,
                     double scan_period_s,
                     std::shared_ptr<const Odometry> odometry = nullptr,
                     std::shared_ptr<const ImuReadings> imu = nullptr);

  // Start and Follow are as those of ScanFollower. Follow throws LostTrack where all
  // hypotheses have lost the rig.
  bool Start(const Scan& scan, bool must_hold = false, std::optional<int64_t> knot_ns = {}) {
    return follower_->Start(scan, must_hold, knot_ns);
  }
  bool StartByGravity(const Scan& scan, std::optional<int64_t> knot_ns = {}) {
    may_fork_ = false;
    return follower_->StartByGravity(scan, knot_ns);
  }
  void Follow(const Scan& scan);

  // The hypothesis that goes on; while there are two, the one that believes what is in view.
  ScanFollower& follower() { return *follower_; }

 private:
  void Fork(int64_t now_ns);
  // Lets both hypotheses follow the scan. Where one of them has lost the rig, the other one
  // goes on.
  void FollowBoth(const Scan& scan);
  bool IsDue(int64_t now_ns) const;
  void Decide();
  void GoOnWith(std::unique_ptr<ScanFollower> follower);

  std::unique_ptr<ScanFollower> follower_;
  std::unique_ptr<ScanFollower> by_motion_;  // nullptr: there is one hypothesis
  std::unique_ptr<ScanMatcher> place_;       // the local map as it was at the fork
  // Sum over the scans since the fork of the points in empty space, less those by the motion.
  double sum_differences_ = 0.0;
  double sum_squared_differences_ = 0.0;
  int64_t held_ns_ = 0;            // for how long walls have held the position of late
  int64_t held_by_motion_ns_ = 0;  // that of by_motion_
  int64_t forked_ns_ = 0;
  int64_t last_scan_ns_ = 0;
  const bool is_on_;      // whether there may be a second hypothesis
  bool may_fork_ = true;  // walls have held the position since the start, or the last fork
};

}  // namespace plumbline
