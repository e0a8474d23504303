#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/trajectory/trajectory.h"

namespace plumbline {

// Rows of a control point: rotation (rad, world frame) and position (m).
inline constexpr int kPoseSize = 6;

// PoseGaussian is a Gaussian on consecutive control points about the values that they had.
// For planar rigs the rows of roll, pitch and height are zero.
struct PoseGaussian {
  int first = 0;
  std::vector<ControlPoint> mean;
  Eigen::MatrixXd information;  // its lower triangle counts

  int end() const { return first + static_cast<int>(mean.size()); }
};

}  // namespace plumbline
