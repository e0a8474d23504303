#pragma once

#include <Eigen/Core>
#include <array>

#include "factors/imu/imu_block.h"
#include "factors/spline/rotation_motion.h"
#include "factors/spline/spline.h"

namespace plumbline {

// BodyReading is what an IMU's sensor measures without errors: the mean of a vector in the
// body frame over the two instants of a measurement, with its derivatives.
struct BodyReading {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  // By the vectors of the steps between the rotation control points.
  RotationMotion::BySteps by_steps = RotationMotion::BySteps::Zero();
  // By the left tangent of the first rotation control point, where all steps are held.
  Eigen::Matrix3d by_first = Eigen::Matrix3d::Zero();
  Eigen::Vector3d by_u = Eigen::Vector3d::Zero();
};

// ReadingBlocks are the values, or the Jacobians (those that are not asked for null; none are
// asked for: all null), of the blocks that the factors of gyroscope and accelerometer share.
template <typename Pointer>
struct ReadingBlocks {
  std::array<Pointer, 4> rotations = {};
  Pointer imu = nullptr;
  Pointer bias = nullptr;
  Pointer next_bias = nullptr;
};

using StepsOfSpline = std::array<RotationStep, 3>;

StepsOfSpline StepsBetween(const std::array<const double*, 4>& rotations);

// Computes the residuals of a measurement,
//   r = ( (1 + scale) o Q^T value + bias - measured ) / stddev,   Q = Exp(turn) body_from_imu,
// and their derivatives by the blocks above; those by the IMU's other numbers are set to zero.
// scale_at: the sensor's scales in the IMU's block. Returns the derivative by the value.
Eigen::Matrix3d EvaluateReading(const ImuMeasurement& measurement,
                                const ImuPose& stated,
                                double knot_interval_s,
                                int scale_at,
                                const BodyReading& reading,
                                const StepsOfSpline& steps,
                                const ReadingBlocks<const double*>& values,
                                double* residuals,
                                const ReadingBlocks<double*>& jacobians);

}  // namespace plumbline
