#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/recording/byte_source.h"

namespace plumbline {

// No scanner takes longer for a scan line.
inline constexpr float kMaxScanSeconds = 2.0f;

// ScanLineMessage is one revolution of one planar scanner as the recording holds it, whatever
// its format: a sensor_msgs/LaserScan, the first echoes of a MultiEchoLaserScan, the points of
// a PointCloud2, or a line of a CARMEN log.
struct ScanLineMessage {
  int64_t stamp_ns = 0;  // instant of the first beam, since 1970
  std::string frame_id;  // empty where the format has none
  // Beam i points along angle_min + i * angle_increment, unless `angles` says otherwise, and
  // is taken i * time_increment after the stamp.
  float angle_min = 0.0f;        // rad
  float angle_increment = 0.0f;  // rad; the mean where the angles are irregular
  float time_increment = 0.0f;   // s
  float range_min = 0.0f;        // m, as the driver states them; 0 where it does not
  float range_max = 0.0f;
  uint32_t num_beams = 0;
  // Metres; NaN where a beam has no echo. Empty where the visitor did not ask for ranges.
  std::vector<float> ranges;
  // Angle of each beam, rad, going round one way; empty if they are regular.
  std::vector<float> angles;
  bool is_planar = true;  // false: a point cloud that does not lie in one scan plane

  // False where angles or times make no sense, or there are no beams.
  bool IsUsable() const;
};

// Transform is how a frame stands in another: an element of a tf2_msgs/TFMessage.
struct Transform {
  std::string parent;  // frame in which the child stands
  std::string child;
  std::array<double, 3> translation = {};                 // m, parent
  std::array<double, 4> rotation = {0.0, 0.0, 0.0, 1.0};  // quaternion x, y, z, w
};

// OdometryMessage is where wheels or another system say that the body is: nav_msgs/Odometry,
// or a CARMEN log's ODOM.
struct OdometryMessage {
  int64_t stamp_ns = 0;  // since 1970
  std::string frame_id;  // of the pose; empty where the format has none
  std::string child_frame_id;
  std::array<double, 3> position = {};                       // m, in frame_id
  std::array<double, 4> orientation = {0.0, 0.0, 0.0, 1.0};  // quaternion x, y, z, w
  std::array<double, 3> linear_velocity = {};                // m/s, in the body's frame
  std::array<double, 3> angular_velocity = {};               // rad/s, in the body's frame

  // Turn about the z axis, rad.
  double Yaw() const;
};

// ImuMessage is a reading of an inertial measurement unit: sensor_msgs/Imu.
struct ImuMessage {
  int64_t stamp_ns = 0;  // since 1970
  std::string frame_id;
  std::array<double, 3> angular_velocity = {};     // rad/s, along the IMU's axes
  std::array<double, 3> linear_acceleration = {};  // m/s^2, along them; at rest upwards
  // Whether the driver says that it measures either.
  bool has_angular_velocity = true;
  bool has_linear_acceleration = true;
};

// JointMessage is the positions of joints: sensor_msgs/JointState, or a number as
// std_msgs/Float64, whose only joint has no name and whose stamp is that of its receipt.
struct JointMessage {
  int64_t stamp_ns = 0;            // since 1970
  std::vector<std::string> names;  // of the joints
  std::vector<double> positions;   // rad
};

// ImageMessage is a picture as rows of pixels: sensor_msgs/Image.
struct ImageMessage {
  int64_t stamp_ns = 0;  // since 1970
  std::string frame_id;
  uint32_t height = 0;   // rows
  uint32_t width = 0;    // pixels of a row
  std::string encoding;  // of a pixel, as ROS names them, such as "16UC1"
  bool is_big_endian = false;
  uint32_t row_bytes = 0;  // from the begin of a row to that of the next
  ByteView data;           // at least height * row_bytes; the message's own, not a copy
};

// CameraInfoMessage says how a camera maps directions to pixels: sensor_msgs/CameraInfo.
struct CameraInfoMessage {
  uint32_t height = 0;  // of its images, pixels
  uint32_t width = 0;
  std::vector<double> distortion;          // of the lens
  std::array<double, 9> camera = {};       // K, by rows
  std::array<double, 12> projection = {};  // P of the rectified image, by rows
};

}  // namespace plumbline
