#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/geometry/matrix_types.h"
#include "core/trajectory/trajectory.h"
#include "factors/spline/spline.h"

namespace plumbline {

// PoseUncertainty holds the joint covariance of the newest control points and gives that of
// poses.
class PoseUncertainty {
 public:
  PoseUncertainty() = default;
  PoseUncertainty(int first, Eigen::MatrixXd covariance)
      : first_(first), covariance_(std::move(covariance)) {}

  // Covariance of the body's rotation (rad, world frame) and position (m) at an instant.
  Matrix6d At(const Trajectory& trajectory, int64_t time_ns) const;
  // Joint covariance of the poses at two instants, six rows each.
  Eigen::Matrix<double, 12, 12> AtBoth(const Trajectory& trajectory,
                                       int64_t first_ns,
                                       int64_t second_ns) const;

 private:
  // Local says how a pose depends on its control points.
  struct Local {
    // First column of each in the covariance; nothing for a control point that is held fixed.
    std::array<std::optional<Eigen::Index>, kSplineOrder> columns;
    SplinePoseJacobian spline;
  };
  Local LocalAt(const Trajectory& trajectory, int64_t time_ns) const;
  // Covariance of pose a (rows) with pose b (columns).
  Matrix6d Between(const Local& a, const Local& b) const;

  int first_ = 0;  // control point of the first six rows
  Eigen::MatrixXd covariance_;
};

}  // namespace plumbline
