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

// Joint covariance of the newest control points, from which that of a pose follows.
class PoseUncertainty {
 public:
  PoseUncertainty() = default;
  PoseUncertainty(int first, Eigen::MatrixXd covariance)
      : first_(first), covariance_(std::move(covariance)) {}

  // World-frame rotation (rad) and position (m) of the body.
  Matrix6d At(const Trajectory& trajectory, int64_t time_ns) const;
  // The same of two poses together.
  Eigen::Matrix<double, 12, 12> AtBoth(const Trajectory& trajectory,
                                       int64_t first_ns,
                                       int64_t second_ns) const;

 private:
  // A pose by the control points that it depends on.
  struct Local {
    // Of each, the first column; nothing for one that is given.
    std::array<std::optional<Eigen::Index>, kSplineOrder> columns;
    SplinePoseJacobian spline;
  };
  Local LocalAt(const Trajectory& trajectory, int64_t time_ns) const;
  // Covariance of one pose (rows) with another one.
  Matrix6d Between(const Local& a, const Local& b) const;

  int first_ = 0;  // control point of the first six rows
  Eigen::MatrixXd covariance_;
};

}  // namespace plumbline
