#pragma once

#include <ceres/jet.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "factors/imu/imu_block.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {

// The functors of gyroscope and accelerometer share these functions; T may be a Jet.

// The rotation and its derivatives as EvaluateRotationMotion() gives them.
inline SplineMotion<double> RotationMotionAt(const double* const q[4],
                                             double u,
                                             double knot_interval_s) {
  return EvaluateRotationMotion(q, u, knot_interval_s);
}

// They depend on 17 of a functor's numbers: they are differentiated by these alone, and then
// by the chain rule, since most time of a Jet goes into the numbers that have no part in it.
template <int N>
SplineMotion<ceres::Jet<double, N>> RotationMotionAt(const ceres::Jet<double, N>* const q[4],
                                                     const ceres::Jet<double, N>& u,
                                                     double knot_interval_s) {
  using Inner = ceres::Jet<double, 4 * 4 + 1>;
  Eigen::Matrix<double, N, Inner::DIMENSION> by_all;
  Inner inner_q[4][4];
  const Inner* inner[4];
  for (int j = 0; j < 4; ++j) {
    inner[j] = inner_q[j];
    for (int i = 0; i < 4; ++i) {
      inner_q[j][i] = Inner(q[j][i].a, 4 * j + i);
      by_all.col(4 * j + i) = q[j][i].v;
    }
  }
  by_all.col(16) = u.v;
  const SplineMotion<Inner> by_inputs =
      EvaluateRotationMotion(inner, Inner(u.a, 16), knot_interval_s);
  const auto chain = [&by_all](const Inner& x) {
    return ceres::Jet<double, N>(x.a, by_all * x.v);
  };
  SplineMotion<ceres::Jet<double, N>> motion;
  motion.world_from_body.coeffs() = by_inputs.world_from_body.coeffs().unaryExpr(chain);
  motion.rate_body = by_inputs.rate_body.unaryExpr(chain);
  motion.angular_acceleration_body = by_inputs.angular_acceleration_body.unaryExpr(chain);
  return motion;
}

// The IMU's attitude in the body that its block stands for.
template <typename T>
Eigen::Quaternion<T> BodyFromImu(const ImuPose& stated, const T* block) {
  const Eigen::Matrix<T, 3, 1> turn(
      block[kImuTurnAt], block[kImuTurnAt + 1], block[kImuTurnAt + 2]);
  return Exp(turn) * stated.body_from_imu.template cast<T>();
}

// r = ( (1 + scale) o value + bias - measured ) / stddev, axis by axis.
template <typename T>
void WhitenReadings(const ImuMeasurement& measurement,
                    const Eigen::Matrix<T, 3, 1>& value,
                    const T* scale,
                    const T* bias,
                    const T* next_bias,
                    T* residuals) {
  const double share = measurement.bias_share;
  for (int axis = 0; axis < 3; ++axis) {
    const T reading = (1.0 + scale[axis]) * value[axis] + (1.0 - share) * bias[axis] +
                      share * next_bias[axis];
    residuals[axis] = (reading - measurement.mean[axis]) / measurement.stddev[axis];
  }
}

}  // namespace plumbline
