#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "factors/imu/imu_block.h"
#include "factors/spline/so3.h"

namespace plumbline {

// The functors of gyroscope and accelerometer share these functions; T may be a Jet.

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
