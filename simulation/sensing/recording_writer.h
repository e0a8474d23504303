#pragma once

#include <memory>
#include <string>

#include "core/sensor/imu.h"
#include "core/sensor/odometry.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "simulation/sensing/mounts.h"

namespace plumbline {

// Writes scan lines, odometry and readings of an IMU as a ROS 1 bag that ROS tools and
// RecordingReader open; the rows of a depth camera as images of depths in mm with the camera's
// sensor_msgs/CameraInfo. The file appears under its name when Close() has written it whole.
class RecordingWriter {
 public:
  RecordingWriter(const std::string& path, const Rig& rig);
  ~RecordingWriter();  // without Close(): the unfinished file is removed

  void Write(const ScanLine& scan_line);
  // In the rig's topic of odometry, as nav_msgs/Odometry without velocities and covariances.
  void Write(const OdometrySample& sample);
  // In the topic of the rig's IMU, as sensor_msgs/Imu without an orientation.
  void Write(const ImuSample& sample);
  // In the topic of the scanner's mount, as sensor_msgs/JointState without velocities.
  void Write(const MountReading& reading);
  void Close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline
