#pragma once

#include <Eigen/Core>

#include "core/options/mapper_options.h"

namespace plumbline {

// MotionNoise holds the standard deviations of the accelerations at the spline's knots that
// the motion prior assumes, as white noise (factors/cost/motion_factor.h). Height has its own,
// since what carries the rig stands on a floor. All rotations share one: a standard deviation
// of tilt alone would be next to nothing on wheels, and a jolt would not be followed.
struct MotionNoise {
  double horizontal_m_s2 = 0.0;
  double vertical_m_s2 = 0.0;
  double angular_rad_s2 = 0.0;

  // The noise that the options give.
  static MotionNoise Of(const TrajectoryOptions& options);

  // Standard deviations along the world axes, m/s^2.
  Eigen::Vector3d Acceleration() const {
    return {horizontal_m_s2, horizontal_m_s2, vertical_m_s2};
  }
};

}  // namespace plumbline
