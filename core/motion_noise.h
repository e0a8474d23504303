#pragma once

#include <Eigen/Core>

#include "core/mapper_options.h"

namespace plumbline {

class EstimationProblem;
class MapCovariance;

// Standard deviations of the accelerations at the spline's knots, white noise: what the prior
// on the motion assumes (factors/motion_factor.h). Height has its own, since what carries the
// rig stands on a floor. All turns share one: tilt alone would be next to nothing on wheels,
// and a jolt not followed.
struct MotionNoise {
  double horizontal_m_s2 = 0.0;
  double vertical_m_s2 = 0.0;
  double angular_rad_s2 = 0.0;

  // As the options give it.
  static MotionNoise Of(const TrajectoryOptions& options);

  // World axes, m/s^2.
  Eigen::Vector3d Acceleration() const {
    return {horizontal_m_s2, horizontal_m_s2, vertical_m_s2};
  }
};

// One step towards the noise that makes the recording likeliest. For the accelerations a_i of
// the estimate under `assumed`, and their posterior variances v_i, of each kind:
//   sigma'^2 = sum a_i^2 / gamma,   gamma = sum (1 - v_i / sigma^2)
// (MacKay 1992, Bayesian Interpolation, section 4). gamma is how many of the
// accelerations the scans determine. Where it stands still, it is the fixed point of EM too,
// sigma^2 = mean(a_i^2 + v_i), which takes several times the steps. A kind that the scans do
// not determine keeps what is assumed.
// accelerations: a problem of nothing but the estimate's motion priors of unit noise.
// covariance: of the estimate.
MotionNoise ReestimateMotionNoise(const MotionNoise& assumed,
                                  const MapCovariance& covariance,
                                  const EstimationProblem& accelerations);

}  // namespace plumbline
