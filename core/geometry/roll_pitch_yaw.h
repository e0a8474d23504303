#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "core/geometry/angles.h"

namespace plumbline {

// Roll, pitch and yaw in degrees of R = Rz(yaw) Ry(pitch) Rx(roll), the inverse of
// RotationFromRollPitchYaw.
inline Eigen::Vector3d RollPitchYawDegrees(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d r = rotation.toRotationMatrix();
  const double cos_pitch = std::hypot(r(0, 0), r(1, 0));
  const double pitch = std::atan2(-r(2, 0), cos_pitch);
  // Looking straight up or down only the sum of roll and yaw counts.
  if (cos_pitch < 1e-9) {
    return Eigen::Vector3d(0.0, pitch, std::atan2(-r(0, 1), r(1, 1))) * kDegreesPerRadian;
  }
  return Eigen::Vector3d(std::atan2(r(2, 1), r(2, 2)), pitch, std::atan2(r(1, 0), r(0, 0))) *
         kDegreesPerRadian;
}

}  // namespace plumbline
