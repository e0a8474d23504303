#include "core/surface/landmark_view.h"

namespace plumbline {

LandmarkView::LandmarkView(const Landmark& of)
    : landmark(&of),
      normal(of.Normal()),
      distance(of.Distance()),
      centre_world(of.extent.Centre()),
      radius_m(of.extent.radius_m()),
      bounds(of.extent.BoundsAboutCentre()),
      traits(TraitsOf(of)),
      is_curved(of.IsCurved()),
      curvature(of.Curvature()),
      heading_fixed(of.heading_fixed),
      plane_by_parameters(of.PlaneByParameters()),
      covariance(of.covariance) {
  if (heading_fixed) plane_by_parameters.col(0).setZero();
}

Eigen::AlignedBox2d LandmarkView::PlanBox(double rim_m) const {
  Eigen::AlignedBox2d box;
  for (const double u : {-1.0, 1.0}) {
    for (const double v : {-1.0, 1.0}) {
      box.extend(
          Eigen::Vector2d((centre_world + u * bounds.half_u + v * bounds.half_v).head<2>()));
    }
  }
  const Eigen::Vector2d rim = Eigen::Vector2d::Constant(bounds.ball_m + rim_m);
  return {box.min() - rim, box.max() + rim};
}

LandmarkView LandmarkView::AtTangentPlane(const Eigen::Vector3d& p_world) const {
  LandmarkView near = *this;
  const Eigen::Vector4d plane = landmark->PlaneNear(p_world);
  near.normal = plane.head<3>();
  near.distance = plane[3];
  near.plane_by_parameters = landmark->PlaneByParameters(p_world);
  return near;
}

Eigen::Matrix<double, 2, 3> LandmarkView::DeviationJacobian(
    const Eigen::Vector3d& p_world, const Eigen::Vector3d& direction_world) const {
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian.row(0) =
      p_world.transpose() * plane_by_parameters.topRows<3>() - plane_by_parameters.row(3);
  jacobian.row(1) = direction_world.transpose() * plane_by_parameters.topRows<3>();
  return jacobian;
}

}  // namespace plumbline
