#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "core/geometry/rigid3.h"

namespace plumbline {

// A planar pose a_from_b takes points of the plane from frame b to frame a:
//   p_a = R(heading) p_b + position
struct PlanarPose {
  double heading = 0.0;                                // rad
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // m

  Eigen::Matrix2d Rotation() const { return Eigen::Rotation2Dd(heading).toRotationMatrix(); }
  PlanarPose Inverse() const { return {-heading, -(Rotation().transpose() * position)}; }
};

// a_from_c = a_from_b * b_from_c; headings are added up, beyond half a turn as well.
inline PlanarPose operator*(const PlanarPose& a_from_b, const PlanarPose& b_from_c) {
  return {a_from_b.heading + b_from_c.heading,
          a_from_b.Rotation() * b_from_c.position + a_from_b.position};
}

inline Eigen::Vector2d operator*(const PlanarPose& a_from_b, const Eigen::Vector2d& p_b) {
  return a_from_b.Rotation() * p_b + a_from_b.position;
}

// The pose as seen from above, for a rig that stands upright.
inline PlanarPose FromAbove(const Rigid3d& pose) {
  const Eigen::Vector3d ahead = pose.rotation * Eigen::Vector3d::UnitX();
  return {std::atan2(ahead.y(), ahead.x()), pose.translation.head<2>()};
}

}  // namespace plumbline
