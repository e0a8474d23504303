#pragma once

#include <Eigen/Core>

namespace plumbline {

// Axes (u, v) on a plane, through an anchor. They stay where they are while the estimate of
// the plane improves, so that coordinates on them keep their meaning.
struct PlaneAxes {
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  // world
  Eigen::Vector3d u = Eigen::Vector3d::UnitX();      // unit vectors, world
  Eigen::Vector3d v = Eigen::Vector3d::UnitY();

  Eigen::Vector2d Project(const Eigen::Vector3d& p_world) const {
    const Eigen::Vector3d from_anchor = p_world - anchor;
    return {u.dot(from_anchor), v.dot(from_anchor)};
  }
  Eigen::Vector3d ToWorld(const Eigen::Vector2d& uv) const {
    return anchor + uv.x() * u + uv.y() * v;
  }
};

}  // namespace plumbline
