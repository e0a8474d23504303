#pragma once

#include <Eigen/Core>
#include <memory>

namespace ceres {
class CostFunction;
}

namespace plumbline {

// Measured motion by wheels from the begin of a knot interval, u = 0, to its end, u = 1: how
// far ahead and to the left, and by which turn about the body's z axis, as seen from the pose
// at the begin. They say nothing of height, roll and pitch.
struct OdometryMeasurement {
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();  // m
  double turn = 0.0;                                      // rad
  double translation_stddev = 1.0;                        // m, in each direction
  double turn_stddev = 1.0;                               // rad
};

// r = [ (R(0)^-1 (p(1) - p(0)))_xy - translation ] / translation_stddev
//     [ Log(R(0)^-1 R(1))_z - turn               ] / turn_stddev           3 residuals
// Blocks: [ rotation x 4 | position x 4 ] control points of the interval. Differentiated
// automatically. At the ends of an interval three of the four control points count.
std::unique_ptr<ceres::CostFunction> CreateOdometryFactor(
    const OdometryMeasurement& measurement);

}  // namespace plumbline
