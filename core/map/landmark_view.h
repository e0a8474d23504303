#pragma once

#include <Eigen/Core>

#include "core/map/landmark.h"

namespace plumbline {

// A landmark as the tests of many observations look at it: the values that they need, computed
// once. Valid as long as the landmark does not change.
struct LandmarkView {
  const Landmark* landmark;
  Eigen::Vector3d normal;
  double distance;
  // A sphere around all that has been seen of the plane. A scan reaches a few of hundreds of
  // planes, and the sphere rules out most others without a look at the landmark itself.
  Eigen::Vector3d centre_world;
  double radius_m;
  // Halves of the sides of the bounding rectangle, as vectors in the world.
  Eigen::Vector3d half_u;
  Eigen::Vector3d half_v;
  bool is_vertical;
  bool heading_fixed;
  Eigen::Matrix2d covariance;

  explicit LandmarkView(const Landmark& of);
  double SignedDistance(const Eigen::Vector3d& p_world) const {
    return normal.dot(p_world) - distance;
  }
  // Variance of the signed distance of a point (m^2), the point taken as given.
  double DistanceVariance(const Eigen::Vector3d& p_world) const {
    if (!is_vertical) return covariance(0, 0);
    const double along =
        heading_fixed ? 0.0 : normal.x() * p_world.y() - normal.y() * p_world.x();
    return along * (along * covariance(0, 0) - 2.0 * covariance(0, 1)) + covariance(1, 1);
  }
  // The derivative of the deviation by the parameters: see Landmark::DeviationJacobian.
  Eigen::Matrix2d DeviationJacobian(const Eigen::Vector3d& p_world,
                                    const Eigen::Vector3d& direction_world) const;
};

}  // namespace plumbline
