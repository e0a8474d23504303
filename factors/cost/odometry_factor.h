#pragma once

#include <Eigen/Core>
#include <memory>

#include "factors/spline/spline.h"

namespace ceres {
class CostFunction;
}

namespace plumbline {

// Measured motion by wheels between two instants: how far ahead and to the left, and by which
// turn about the body's z axis, as seen from the pose at the first one. They say nothing of
// height, roll and pitch.
struct OdometryMeasurement {
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();  // m
  double turn = 0.0;                                      // rad
  double translation_stddev = 1.0;                        // m, in each direction
  double turn_stddev = 1.0;                               // rad
};

// r = [ (R(a)^-1 (p(b) - p(a)))_xy - translation ] / translation_stddev
//     [ Log(R(a)^-1 R(b))_z - turn               ] / turn_stddev           3 residuals
// Blocks: [ rotation x m | position x m ] consecutive control points, which the instants a,
// begin, and b, end, count from the first one of. Differentiated automatically.
std::unique_ptr<ceres::CostFunction> CreateOdometryFactor(
    const OdometryMeasurement& measurement,
    const SplineNode& begin,
    const SplineNode& end,
    int num_control_points);

}  // namespace plumbline
