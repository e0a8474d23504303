#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/options/mapper_options.h"
#include "core/trajectory/trajectory.h"

namespace ceres {
class CostFunction;
}

namespace plumbline {

// A prior on the motion (factors/cost/motion_factor.h, factors/cost/position_factor.h), for a
// system of control points with 6 rows each: rotation (rad, world frame) and position (m).
struct MotionTerm {
  struct Block {
    int row = 0;  // first of three
    bool is_rotation = false;
    double* data = nullptr;
  };
  std::shared_ptr<ceres::CostFunction> cost;  // three residuals
  std::vector<Block> blocks;

  // Adds the cost at the blocks' values, its gradient and its Gauss-Newton matrix.
  void AddTo(double* total_cost, Eigen::VectorXd* gradient, Eigen::MatrixXd* hessian) const;
};

// The priors that hold the control points from `first` on to each other, as far as those
// before `known` do not carry them already. origin_time_ns: at the start of the map also the
// unknown velocity and the origin at that instant. The terms point into the trajectory.
std::vector<MotionTerm> MakeMotionTerms(const TrajectoryOptions& options,
                                        int first,
                                        int known,
                                        std::optional<int64_t> origin_time_ns,
                                        Trajectory* trajectory);

}  // namespace plumbline
