#pragma once

#include <ceres/jet.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>

#include "factors/imu/imu_block.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {

// The functors of gyroscope and accelerometer share these functions; T may be a Jet.

// Steps and motion depend on few of a functor's numbers. They are differentiated by these
// alone, and then by the chain rule, since most time of a Jet goes into the numbers that have
// no part in it.
template <typename T>
using Steps = std::array<Eigen::Matrix<T, 3, 1>, 3>;

// A Jet of N numbers from one of M inner ones, whose derivatives by the N are the columns.
template <int N, int M>
ceres::Jet<double, N> Chain(const ceres::Jet<double, M>& inner,
                            const Eigen::Matrix<double, N, M>& by_all) {
  return ceres::Jet<double, N>(inner.a, by_all * inner.v);
}

// See RotationSteps().
inline Steps<double> StepsOf(const double* const q[4]) { return RotationSteps(q); }

// A step depends on its two control points.
template <int N>
Steps<ceres::Jet<double, N>> StepsOf(const ceres::Jet<double, N>* const q[4]) {
  using Inner = ceres::Jet<double, 8>;
  Steps<ceres::Jet<double, N>> steps;
  for (size_t j = 0; j < 3; ++j) {
    Inner ends[2][4];
    Eigen::Matrix<double, N, 8> by_all;
    for (int i = 0; i < 8; ++i) {
      const ceres::Jet<double, N>& number = q[j + static_cast<size_t>(i / 4)][i % 4];
      ends[i / 4][i % 4] = Inner(number.a, i);
      by_all.col(i) = number.v;
    }
    const Eigen::Matrix<Inner, 3, 1> step = StepBetween(ends[0], ends[1]);
    for (int i = 0; i < 3; ++i) steps[j][i] = Chain(step[i], by_all);
  }
  return steps;
}

// See EvaluateRotationMotion().
template <bool kRateOnly = false>
SplineMotion<double> MotionOf(const Steps<double>& steps, double u, double knot_interval_s) {
  return EvaluateRotationMotion<kRateOnly>(steps, u, knot_interval_s);
}

// The motion depends on the nine numbers of the steps and the instant.
template <bool kRateOnly = false, int N>
SplineMotion<ceres::Jet<double, N>> MotionOf(const Steps<ceres::Jet<double, N>>& steps,
                                             const ceres::Jet<double, N>& u,
                                             double knot_interval_s) {
  using Inner = ceres::Jet<double, 10>;
  Steps<Inner> inner;
  Eigen::Matrix<double, N, 10> by_all;
  for (int i = 0; i < 9; ++i) {
    const ceres::Jet<double, N>& number = steps[static_cast<size_t>(i / 3)][i % 3];
    inner[static_cast<size_t>(i / 3)][i % 3] = Inner(number.a, i);
    by_all.col(i) = number.v;
  }
  by_all.col(9) = u.v;
  const SplineMotion<Inner> by_inputs =
      EvaluateRotationMotion<kRateOnly>(inner, Inner(u.a, 9), knot_interval_s);
  const auto chain = [&by_all](const Inner& x) { return Chain(x, by_all); };
  SplineMotion<ceres::Jet<double, N>> motion;
  motion.rate_body = by_inputs.rate_body.unaryExpr(chain);
  if (kRateOnly) return motion;
  motion.first_from_body.coeffs() = by_inputs.first_from_body.coeffs().unaryExpr(chain);
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
