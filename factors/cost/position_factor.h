#pragma once

#include <Eigen/Core>
#include <memory>

namespace ceres {
class CostFunction;
}

namespace plumbline {

// The spline's position at u equals a given point: fixes the origin of the model frame
// (gauge).
//   r = (p(u) - position) / stddev        three residuals, position and stddev in m
// Blocks: [ p0 | p1 | p2 | p3 ]
// Fixing one control point instead would not fix the pose, which mixes three of them.
std::unique_ptr<ceres::CostFunction> CreatePositionFactor(const Eigen::Vector3d& position,
                                                          double u,
                                                          double stddev);

}  // namespace plumbline
