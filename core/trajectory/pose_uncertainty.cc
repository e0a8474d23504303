#include "core/trajectory/pose_uncertainty.h"

#include "core/geometry/matrix_types.h"
#include "core/trajectory/pose_gaussian.h"

namespace plumbline {
PoseUncertainty::Local PoseUncertainty::LocalAt(const Trajectory& trajectory,
                                                int64_t time_ns) const {
  const Trajectory::Location at = trajectory.Locate(time_ns);
  Local local;
  local.spline = trajectory.PoseJacobian(at);
  for (int j = 0; j < kSplineOrder; ++j) {
    const Eigen::Index column = kPoseSize * (at.first + j - first_);
    if (column < 0 || column >= covariance_.cols()) continue;
    local.columns[static_cast<size_t>(j)] = column;
  }
  return local;
}

// A control point turns the pose by its turn alone and shifts it by its shift alone: blocks of
// three are multiplied, and nothing by zero.
Matrix6d PoseUncertainty::Between(const Local& a, const Local& b) const {
  Matrix6d result = Matrix6d::Zero();
  for (size_t j = 0; j < kSplineOrder; ++j) {
    if (!b.columns[j]) continue;
    Matrix6d cross = Matrix6d::Zero();  // of the pose a with the control point
    for (size_t i = 0; i < kSplineOrder; ++i) {
      if (!a.columns[i]) continue;
      const Matrix6d block = covariance_.block<6, 6>(*a.columns[i], *b.columns[j]);
      cross.topRows<3>() += a.spline.rotation_wrt_control[i].lazyProduct(block.topRows<3>());
      cross.bottomRows<3>() += a.spline.position_weights[i] * block.bottomRows<3>();
    }
    result.leftCols<3>() +=
        cross.leftCols<3>().lazyProduct(b.spline.rotation_wrt_control[j].transpose());
    result.rightCols<3>() += b.spline.position_weights[j] * cross.rightCols<3>();
  }
  return result;
}

Matrix6d PoseUncertainty::At(const Trajectory& trajectory, int64_t time_ns) const {
  const Local local = LocalAt(trajectory, time_ns);
  return Between(local, local);
}

Eigen::Matrix<double, 12, 12> PoseUncertainty::AtBoth(const Trajectory& trajectory,
                                                      int64_t first_ns,
                                                      int64_t second_ns) const {
  const Local first = LocalAt(trajectory, first_ns);
  const Local second = LocalAt(trajectory, second_ns);
  const Matrix6d cross = Between(first, second);
  Eigen::Matrix<double, 12, 12> joint;
  joint << Between(first, first), cross, cross.transpose(), Between(second, second);
  return joint;
}

}  // namespace plumbline
