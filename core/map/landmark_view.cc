#include "core/map/landmark_view.h"

#include <glog/logging.h>

namespace plumbline {

LandmarkView::LandmarkView(const Landmark& of)
    : landmark(&of),
      normal(of.Normal()),
      distance(of.Distance()),
      centre_world(of.extent.Centre()),
      radius_m(of.extent.radius_m()),
      half_u(0.5 * (of.extent.max_corner() - of.extent.min_corner()).x() * of.extent.u_axis()),
      half_v(0.5 * (of.extent.max_corner() - of.extent.min_corner()).y() * of.extent.v_axis()),
      is_vertical(of.model == PlaneModel::kVertical),
      heading_fixed(of.heading_fixed),
      covariance(of.covariance) {}

Eigen::Matrix2d LandmarkView::DeviationJacobian(const Eigen::Vector3d& p_world,
                                                const Eigen::Vector3d& direction_world) const {
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();
  if (landmark->model == PlaneModel::kHorizontal) {
    jacobian(0, 0) = -1.0;
    return jacobian;
  }
  CHECK(is_vertical);
  if (!heading_fixed) {
    const Eigen::Vector3d normal_by_angle(-normal.y(), normal.x(), 0.0);
    jacobian(0, 0) = normal_by_angle.dot(p_world);
    jacobian(1, 0) = normal_by_angle.dot(direction_world);
  }
  jacobian(0, 1) = -1.0;
  return jacobian;
}

}  // namespace plumbline
