#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "core/surface/landmark.h"
#include "core/surface/patch_extent.h"

namespace plumbline {

// A landmark as the tests of many observations look at it: the values that they need, computed
// once. Valid as long as the landmark does not change. Of a cylinder it is the plane that
// stands for it near a point, at first its chart's anchor: see Near.
struct LandmarkView {
  const Landmark* landmark;
  Eigen::Vector3d normal;
  double distance;
  // A sphere around all that has been seen of the plane. A scan reaches a few of hundreds of
  // planes, and the sphere rules out most others without a look at the landmark itself.
  Eigen::Vector3d centre_world;
  double radius_m;
  PatchExtent::Bounds bounds;
  SurfaceTraits traits;
  bool is_curved;    // a cylinder is, though it may hardly bend
  double curvature;  // Landmark::Curvature
  bool heading_fixed;
  // The derivatives of normal and distance by the parameters; what the gauge holds is zero.
  Eigen::Matrix<double, 4, 3> plane_by_parameters;
  Eigen::Matrix3d covariance;

  explicit LandmarkView(const Landmark& of);
  // The view of the surface as it is near the point: of a plane this one, else one that is
  // put into storage.
  const LandmarkView& Near(const Eigen::Vector3d& p_world,
                           std::optional<LandmarkView>* storage) const {
    return is_curved ? storage->emplace(AtTangentPlane(p_world)) : *this;
  }
  // The surface's unit normal at the point.
  Eigen::Vector3d UnitNormalNear(const Eigen::Vector3d& p_world) const {
    return is_curved ? landmark->NormalNear(p_world).normalized() : normal;
  }
  // Signed distance; of a cylinder that of the landmark, wherever the view is near.
  double SignedDistance(const Eigen::Vector3d& p_world) const {
    if (is_curved) return landmark->SignedDistance(p_world);
    return normal.dot(p_world) - distance;
  }
  // How far from its centre what has been seen reaches along a unit vector, at most, m.
  double ReachAlong(const Eigen::Vector3d& direction_world) const {
    return std::abs(direction_world.dot(bounds.half_u)) +
           std::abs(direction_world.dot(bounds.half_v)) + bounds.ball_m;
  }
  // A box on the floor plan around all that has been seen, with a rim around it.
  Eigen::AlignedBox2d PlanBox(double rim_m) const;
  // Variance of the signed distance of a point (m^2), the point taken as given.
  double DistanceVariance(const Eigen::Vector3d& p_world) const {
    const Eigen::RowVector3d by_parameters =
        p_world.transpose() * plane_by_parameters.topRows<3>() - plane_by_parameters.row(3);
    return by_parameters.dot(by_parameters * covariance);
  }
  // The derivative of the deviation by the parameters: see Landmark::DeviationJacobian.
  Eigen::Matrix<double, 2, 3> DeviationJacobian(const Eigen::Vector3d& p_world,
                                                const Eigen::Vector3d& direction_world) const;

 private:
  LandmarkView AtTangentPlane(const Eigen::Vector3d& p_world) const;
};

}  // namespace plumbline
