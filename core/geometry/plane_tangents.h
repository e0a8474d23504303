#pragma once

#include <Eigen/Core>
#include <cmath>

namespace plumbline {

// Two unit vectors along a plane, a function of its unit normal alone: u is level, and v, for
// a plane that is not, points upwards. Of a level plane u is the world's x axis.
inline Eigen::Matrix<double, 3, 2> PlaneTangents(const Eigen::Vector3d& normal) {
  constexpr double kMinSlope = 1e-9;  // below it the level direction is rounding error
  Eigen::Matrix<double, 3, 2> tangents;
  const Eigen::Vector3d level = Eigen::Vector3d::UnitZ().cross(normal);
  tangents.col(0) = level.norm() < kMinSlope ? Eigen::Vector3d(Eigen::Vector3d::UnitX())
                                             : Eigen::Vector3d(level.normalized());
  tangents.col(1) = normal.cross(tangents.col(0));
  return tangents;
}

}  // namespace plumbline
