#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

namespace plumbline {

// The unknowns of an IMU that do not change, as a parameter block about what its rig file
// states:
//   [ turn (rad) | shift (m) | delay (s) | gyroscope's scales | accelerometer's scales | lean
//   (rad) ]
// turn, shift: in the body frame; body_from_imu = ( Exp(turn) R, t + shift ).
// delay: readings were taken later by this than their stamps say. scales: a reading is
// 1 + scale of what it measures, by axis. lean: gravity is Exp(lean_x, lean_y, 0) (0, 0, -g).
// Biases change, and are blocks of their own.
enum ImuBlockAt {
  kImuTurnAt = 0,
  kImuShiftAt = 3,
  kImuDelayAt = 6,
  kImuGyroscopeScaleAt = 7,
  kImuAccelerometerScaleAt = 10,
  kImuLeanAt = 13,
  kImuBlockSize = 15
};
inline constexpr int kImuBiasSize = 3;

// ImuPose is the stated pose of an IMU on the body.
struct ImuPose {
  Eigen::Quaterniond body_from_imu = Eigen::Quaterniond::Identity();
  Eigen::Vector3d position_body = Eigen::Vector3d::Zero();
};

// ImuMeasurement is the mean of some readings of three axes within a knot interval. Its
// readings' times have a mean and a standard deviation; the mean of a function of time of the
// third order over them is that of its values at `mean - stddev` and `mean + stddev`.
struct ImuMeasurement {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d stddev = Eigen::Vector3d::Ones();  // of the mean; infinite: no measurement
  std::array<double, 2> u = {0.0, 0.0};  // mean - stddev, mean + stddev, in knot intervals
  double bias_share = 0.0;  // the bias is (1 - share) of one block and share of the next
};

}  // namespace plumbline
