#pragma once

#include <Eigen/Core>
#include <optional>
#include <set>

#include "core/options/mapper_options.h"
#include "core/trajectory/gravity_start.h"
#include "core/trajectory/motion_noise.h"
#include "core/trajectory/trajectory.h"

namespace plumbline {

// MotionPrior gives the noise of the motion prior on three control points while the rig is
// followed: that of the motion of the last seconds, as the scans have shown it.
//
// For the innovations e_k of the accelerations at the knots (MotionNoise) and their posterior
// variances v_k, of each kind,
//   sigma^2 = (n_0 sigma_0^2 + sum e_k^2) / (n_0 + sum (1 - v_k / sigma^2))
// The second sum is how many of the innovations the scans determine (MacKay 1992, "Bayesian
// Interpolation", section 4); where they determine none the strength stays. Sums forget: a rig
// walks, stands and is handed on. n_0 and sigma_0 are what the options say of any rig.
//
// Unlike that of the batch (MotionProfile) it does not follow single stretches: while
// associations are being made, a prior that lets the rig jump for a small price lets it slip
// to the next surface.
//
// Where the motion alone has to bridge what no scan shows, it is at most that of a rig that
// keeps its pace: any wall would take hold of one that may be anywhere.
class MotionPrior {
 public:
  explicit MotionPrior(const TrajectoryOptions& options);

  // Returns the noise of the control points first .. first + 2.
  MotionNoise At(int first) const;
  // Returns the noise of motions whose accelerations are not known yet.
  const MotionNoise& usual() const { return usual_; }

  // Takes the mean vertical velocity of the last second, up to a control point, from the
  // trajectory.
  void FollowHeight(const Trajectory& trajectory, int last);

  // Takes in what the scans have shown of the innovation of the control points first ..
  // first + 3. variance: its posterior one, along and about the world's axes.
  void Learn(const Trajectory& trajectory,
             int first,
             const Eigen::Vector3d& linear_variance,
             const Eigen::Vector3d& angular_variance);

  // Forgets what the scans have shown: where they show nothing, the rig may move as any rig.
  void Forget();

  // How the rig stands and goes at the start, of a map that starts by gravity; nothing where
  // planes give its attitude.
  const std::optional<GravityStart>& start() const { return start_; }
  void set_start(const GravityStart& start) { start_ = start; }

  // Makes the motion bridge the control points first .. end - 1.
  void Bridge(int first, int end);

 private:
  MotionNoise usual_;
  double bridging_density_;
  std::optional<GravityStart> start_;
  std::set<int> bridged_;
  bool learns_;
  MotionNoise initial_;
  ByMotionKind squares_ = {};     // of innovations over their initial variance
  ByMotionKind determined_ = {};  // number of innovations
};

}  // namespace plumbline
