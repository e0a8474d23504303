#include "core/pose_uncertainty.h"

#include <algorithm>

#include "factors/spline.h"

namespace plumbline {
namespace {

constexpr int kPoseSize = 6;  // rows of a control point

}  // namespace

PoseUncertainty::Local PoseUncertainty::LocalJacobian(const Trajectory& trajectory,
                                                      int64_t time_ns) const {
  const Trajectory::Location at = trajectory.Locate(time_ns);
  const SplinePoseJacobian spline = trajectory.PoseJacobian(at);
  Local local;
  // A pose before the first control point that is known depends on given ones as well.
  const int known = std::max(at.first, first_);
  const int last = static_cast<int>(covariance_.cols()) / kPoseSize + first_ - kSplineOrder;
  const int begin = std::min(known, last);
  local.column = kPoseSize * (begin - first_);
  local.jacobian.setZero();
  for (int j = 0; j < kSplineOrder; ++j) {
    const int column = kPoseSize * (at.first + j - begin);
    if (column < 0 || column >= local.jacobian.cols()) continue;
    const auto index = static_cast<size_t>(j);
    local.jacobian.block<3, 3>(0, column) = spline.rotation_wrt_control[index];
    local.jacobian.block<3, 3>(3, column + 3)
        .diagonal()
        .setConstant(spline.position_weights[index]);
  }
  return local;
}

Matrix6d PoseUncertainty::At(const Trajectory& trajectory, int64_t time_ns) const {
  const Local local = LocalJacobian(trajectory, time_ns);
  const Eigen::Matrix<double, 6, 24> cross =
      local.jacobian * covariance_.block<24, 24>(local.column, local.column);
  return cross.lazyProduct(local.jacobian.transpose());
}

Eigen::Matrix<double, 12, 12> PoseUncertainty::AtBoth(const Trajectory& trajectory,
                                                      int64_t first_ns,
                                                      int64_t second_ns) const {
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(12, covariance_.cols());
  const Local first = LocalJacobian(trajectory, first_ns);
  const Local second = LocalJacobian(trajectory, second_ns);
  jacobian.block<6, 24>(0, first.column) = first.jacobian;
  jacobian.block<6, 24>(6, second.column) = second.jacobian;
  return jacobian * covariance_ * jacobian.transpose();
}

}  // namespace plumbline
