#pragma once

#include <Eigen/Core>

#include "core/options/mapper_options.h"

namespace plumbline {

// Standard deviations of the accelerations at the spline's knots, white noise: what the prior
// on the motion assumes (factors/cost/motion_factor.h). Height has its own, since what carries
// the rig stands on a floor. All turns share one: tilt alone would be next to nothing on
// wheels, and a jolt not followed.
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

}  // namespace plumbline
