#pragma once

#include "core/recording/messages.h"
#include "core/recording/serial_reader.h"

namespace plumbline {

// Read ROS messages, of ROS 1 or ROS 2, all of them: false where their lengths do not agree
// with the number of their bytes.
//   with_ranges   else the ranges are not copied
bool ReadLaserScan(SerialReader reader, bool with_ranges, ScanLineMessage* message);
// The first echo of each beam counts.
bool ReadMultiEchoLaserScan(SerialReader reader, bool with_ranges, ScanLineMessage* message);
// A tf2_msgs/TFMessage.
bool ReadTransforms(SerialReader reader, std::vector<Transform>* transforms);
bool ReadOdometry(SerialReader reader, OdometryMessage* message);
bool ReadImu(SerialReader reader, ImuMessage* message);
// Names and positions of a sensor_msgs/JointState.
bool ReadJoints(SerialReader reader, JointMessage* message);
// A std_msgs/Float64 as the position of a joint without a name; its stamp is left alone.
bool ReadNumber(SerialReader reader, JointMessage* message);
// A sensor_msgs/Image, whose data stay where they are.
bool ReadImage(SerialReader reader, ImageMessage* message);
bool ReadCameraInfo(SerialReader reader, CameraInfoMessage* message);

}  // namespace plumbline
