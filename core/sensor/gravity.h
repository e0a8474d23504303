#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "core/sensor/imu.h"

namespace plumbline {

// UpDirection is the direction against gravity as a rig's body has it at an instant.
struct UpDirection {
  Eigen::Vector3d up_body = Eigen::Vector3d::UnitZ();
  double stddev_rad = 0.0;  // about each axis across it
};

// Finds the direction against gravity at an instant: the mean of what the accelerometer reads
// from then on, each reading turned back by what the gyroscope says that the rig has turned
// since. A longer time has less of the rig's own acceleration in its mean, but more of the
// gyroscope's errors; it ends where both together are least. acceleration_density_m_s2: of the
// rig's accelerations, per square root of 1 Hz (TrajectoryOptions). Returns nothing where the
// IMU has no readings, or only such at the end of their range.
std::optional<UpDirection> FindUp(const ImuReadings& readings,
                                  const Imu& imu,
                                  int64_t time_ns,
                                  double acceleration_density_m_s2);

}  // namespace plumbline
