#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>

#include "core/association.h"
#include "core/trajectory.h"

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
  // The control points that a pose depends on: first column, derivative.
  struct Local {
    Eigen::Index column = 0;
    Eigen::Matrix<double, 6, 24> jacobian;
  };
  Local LocalJacobian(const Trajectory& trajectory, int64_t time_ns) const;

  int first_ = 0;  // control point of the first six rows
  Eigen::MatrixXd covariance_;
};

}  // namespace plumbline
