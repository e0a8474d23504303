#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace plumbline {

// Axes (u, v) on a plane, through an anchor. They stay where they are while the estimate of
// the plane improves, so that coordinates on them keep their meaning. On an upright cylinder u
// is measured along the arc, and v upwards.
struct PlaneAxes {
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  // world
  Eigen::Vector3d u = Eigen::Vector3d::UnitX();      // unit vectors, world
  Eigen::Vector3d v = Eigen::Vector3d::UnitY();
  double curvature =
      0.0;  // 1/m, of the arc; negative where the axis lies on the side of u x v

  Eigen::Vector2d Project(const Eigen::Vector3d& p_world) const {
    const Eigen::Vector3d from_anchor = p_world - anchor;
    if (curvature == 0.0) return {u.dot(from_anchor), v.dot(from_anchor)};
    const double outwards = 1.0 + curvature * u.cross(v).dot(from_anchor);
    return {std::atan2(curvature * u.dot(from_anchor), outwards) / curvature,
            v.dot(from_anchor)};
  }
  Eigen::Vector3d ToWorld(const Eigen::Vector2d& uv) const {
    if (curvature == 0.0) return anchor + uv.x() * u + uv.y() * v;
    const double angle = curvature * uv.x();
    return anchor + std::sin(angle) / curvature * u +
           (std::cos(angle) - 1.0) / curvature * u.cross(v) + uv.y() * v;
  }
  // Circumference of the whole circle of an arc, m.
  double Circumference() const { return 2.0 * M_PI / std::abs(curvature); }
};

}  // namespace plumbline
