#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>

#include "core/sensor/imu.h"
#include "factors/imu/imu_block.h"

namespace plumbline {

using ImuBlock = std::array<double, kImuBlockSize>;
using ImuMatrix = Eigen::Matrix<double, kImuBlockSize, kImuBlockSize>;
using ImuBias = std::array<double, kImuBiasSize>;

// ImuBiases are the biases at one node of time.
struct ImuBiases {
  ImuBias gyroscope = {};      // rad/s
  ImuBias accelerometer = {};  // m/s^2
  // Covariances of both biases as they are now.
  Eigen::Matrix3d gyroscope_covariance = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d accelerometer_covariance = Eigen::Matrix3d::Zero();
};

// ImuEstimate is what is estimated of an IMU: a block about what the rig file states, and
// biases, linear in time between nodes that lie a number of knot intervals apart. A rig that
// moves in the plane has a gyroscope about the vertical only.
struct ImuEstimate {
  Imu stated;
  bool planar = false;
  ImuBlock block = {};        // as it is estimated now
  ImuBlock prior_sigma = {};  // 0: held
  ImuMatrix covariance = ImuMatrix::Zero();
  int intervals_per_bias = 1;
  std::deque<ImuBiases> biases;  // node i at the begin of knot interval i * intervals_per_bias

  ImuEstimate() = default;
  ImuEstimate(const Imu& stated, bool planar, double knot_interval_s);

  ImuPose Pose() const {
    return {stated.body_from_imu.rotation, stated.body_from_imu.translation};
  }
  // Makes the nodes of the knot intervals before this one that are missing; they continue the
  // last one.
  void ExtendTo(int knot_interval);
  int num_biases() const { return static_cast<int>(biases.size()); }
  // The last knot interval that a node has a say in.
  int LastIntervalOf(int node) const { return (node + 1) * intervals_per_bias - 1; }
  int NodeOfLastInterval(int knot_interval) const {
    return (knot_interval + 1) / intervals_per_bias - 1;
  }
};

}  // namespace plumbline
