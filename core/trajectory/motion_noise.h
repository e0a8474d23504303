#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "core/options/mapper_options.h"
#include "core/trajectory/trajectory.h"
#include "factors/cost/motion_factor.h"

namespace plumbline {

// The kinds of motion whose accelerations have strengths of their own: what carries the rig
// stands on a floor and turns on it, and hardly ever rises or tilts alike. Tilts are rotations
// about the world's x and y axes, yaw is about its z axis: a body that leans turns upright.
enum MotionKind : size_t { kHorizontal, kVertical, kTilt, kYaw, kNumMotionKinds };
using ByMotionKind = std::array<double, kNumMotionKinds>;

// KnotAcceleration drives the motion at the knot between control points first .. first + 2:
// accelerations, their second differences over the square of the knot interval, and of
// velocities that do not go on what is lacking of those (factors/cost/motion_factor.h).
struct KnotAcceleration {
  Eigen::Vector3d linear_world = Eigen::Vector3d::Zero();  // m/s^2
  Eigen::Vector3d angular_world = Eigen::Vector3d::Zero();  // rad/s^2

  static KnotAcceleration At(const Trajectory& trajectory,
                             int first,
                             const MotionPersistence& persistence = {});
};

// Sums of squares by kind of motion, of accelerations along and about the world's axes, and
// the number of axes of each kind.
ByMotionKind SumByKind(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular);
inline constexpr ByMotionKind kNumAxes = {2.0, 1.0, 2.0, 1.0};

// Returns the mean vertical velocity from one control point to another, m/s; both are clamped
// to those there are. A time of less than a second counts as one.
double MeanVerticalVelocity(const Trajectory& trajectory, int first, int last);
// Number of knot intervals in the second that such a mean is of.
int KnotsOfMean(const Trajectory& trajectory);

// MotionNoise is what the motion prior expects of accelerations: that they are correlated
// exponentially over time (Singer 1970, "Estimating optimal tracking filter performance for
// manned maneuvering targets"). Its densities are amplitude spectral ones at low frequencies,
// in m/s^2/sqrt(Hz) and rad/s^2/sqrt(Hz), as data sheets of accelerometers give theirs.
// Neither they nor the correlation time change their meaning with the spline's knots. With the
// persistence rho = exp(-h / correlation time) from knot to knot of interval h, and
// sigma = density / sqrt(h),
//   a_k+1 = rho a_k + e_k,  stddev(e) = sigma (1 - rho),
//   stddev(a) = sigma sqrt((1 - rho) / (1 + rho)).
// A correlation time of 0 is white noise.
//
// Vertically, velocities are correlated so, about their mean m of a second (steps on a floor
// or a stair), and white noise drives them: v_k+1 - m = rho_v (v_k - m) + h e_k. What carries
// the rig stands on a floor: where nothing shows the height, an acceleration that goes on, of
// a step, would carry it away. Half a second ahead the height of a walk that bobs by 2 cm is
// known to 3 cm instead of 21.
struct MotionNoise {
  ByMotionKind density = {};
  double correlation_s = 0.0;
  double vertical_velocity_correlation_s = 1e3;
  double vertical_velocity_m_s = 0.0;  // mean of some steps, that velocities return to

  // The noise that the options expect of any rig.
  static MotionNoise Of(const TrajectoryOptions& options);

  double Persistence(double knot_interval_s) const;  // rho, of angular accelerations
  MotionPersistence LinearPersistence(double knot_interval_s) const;
  // Standard deviations at knots of this interval, along the world's axes (m/s^2) and about
  // them (rad/s^2): of accelerations, and of what does not follow from the one before.
  Eigen::Vector3d LinearStddev(double knot_interval_s) const;
  Eigen::Vector3d AngularStddev(double knot_interval_s) const;
  Eigen::Vector3d LinearInnovationStddev(double knot_interval_s) const;
  Eigen::Vector3d AngularInnovationStddev(double knot_interval_s) const;
  // Factors that turn the square of an innovation into that of a density.
  ByMotionKind DensityPerInnovation2(double knot_interval_s) const;
  // Returns the innovation: the part of what drives the motion at the second of two neighbouring
  // knots that does not follow from the first, the control points first .. first + 2.
  KnotAcceleration InnovationAt(const Trajectory& trajectory, int first) const;
};

// Evidence of an estimate on the noise at one knot, by kind of motion and summed over its
// axes: an unbiased estimate of the density's square, times its weight, and the weight, the
// number of innovations that would tell as much if they were known exactly.
struct MotionEvidence {
  ByMotionKind squares = {};  // m^2/s^3, rad^2/s^3
  ByMotionKind weight = {};
  double by_prior = 0.0;    // number of unknowns that the prior, not the scans, determines
  double prior_cost = 0.0;  // half the sum of the prior's squared residuals
};

MotionEvidence SumOf(const std::vector<MotionEvidence>& evidence);

// MotionProfile is the motion noise of a whole recording: usual, and at each knot that of its
// own stretch. A rig goes straight, turns, and stands: noise that is right on average bends
// the turns, and states too large deviations for what is between them.
struct MotionProfile {
  MotionNoise usual;
  std::vector<MotionNoise> at;  // by the first of the three control points

  // Takes the mean vertical velocity at each knot, over a second about it, from the
  // trajectory.
  void FollowHeight(const Trajectory& trajectory);

  static MotionProfile Uniform(const MotionNoise& noise, const Trajectory& trajectory);
  // The noise that follows from what an estimate tells whose usual noise was `before`:
  //   usual^2 = (w before^2 + sum squares) / (w + sum weight)
  // over all knots, and over those within a quarter of a second of one, with `usual` instead
  // of `before`, for the noise there. w: one innovation.
  static MotionProfile From(const std::vector<MotionEvidence>& evidence,
                            const MotionNoise& before,
                            double knot_interval_s);
  // The noise of a motion that is known exactly.
  static MotionProfile Of(const Trajectory& known, const MotionNoise& initial);
};

}  // namespace plumbline
