#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>

namespace ceres {
class CostFunction;
}

namespace plumbline {

// Information on a rig's pose at one instant, linearised at the pose `world_from_body`,
// `position`: a linear form in the error x of the pose, rotation (rad, left tangent, world
// frame) and then position (m).
struct PoseMeasurement {
  Eigen::Quaterniond world_from_body = Eigen::Quaterniond::Identity();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 6, 6> root = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> offset = Eigen::Matrix<double, 6, 1>::Zero();
};

// r = offset + root (Log(R(u) R0^-1), p(u) - p0)        6 residuals
// Blocks: [ rotation x 4 | position x 4 ] control points of the interval, u in [0, 1).
std::unique_ptr<ceres::CostFunction> CreatePoseFactor(const PoseMeasurement& measurement,
                                                      double u);

}  // namespace plumbline
