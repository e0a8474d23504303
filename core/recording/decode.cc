#include "core/recording/decode.h"

#include <string>

#include "core/recording/carmen_messages.h"
#include "core/recording/point_cloud.h"
#include "core/recording/ros_messages.h"
#include "core/recording/serial_reader.h"

namespace plumbline {
namespace {

struct KnownType {
  const char* type;
  const char* ros1_definition;
  MessageKind kind;
};

constexpr KnownType kKnownTypes[] = {
    {"sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369", MessageKind::kLaserScan},
    {"sensor_msgs/MultiEchoLaserScan",
     "6fefb0c6da89d7c8abe4b339f5c2f8fb",
     MessageKind::kMultiEchoLaserScan},
    {"sensor_msgs/PointCloud2", "1158d486dd51d683ce2f1be655c3c181", MessageKind::kPointCloud2},
    {"nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7", MessageKind::kOdometry},
    {"sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2", MessageKind::kImu},
    {"sensor_msgs/JointState", "3066dcd76a6cfaef579bd0f34173e9fd", MessageKind::kJoints},
    {"std_msgs/Float64", "fdb28210bfa9d7c91146260178d9a584", MessageKind::kNumber},
    {"sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743", MessageKind::kImage},
    {"sensor_msgs/CameraInfo", "c9a58c1b0b154e0e6da7578cb991d214", MessageKind::kCameraInfo},
    {"tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec", MessageKind::kTransforms},
};

// ROS 2 writes "sensor_msgs/msg/LaserScan".
std::string WithoutMsg(const std::string& type) {
  const size_t at = type.find("/msg/");
  return at == std::string::npos ? type : type.substr(0, at) + type.substr(at + 4);
}

bool DecodeRosScanLine(MessageKind kind,
                       const SerialReader& reader,
                       bool with_ranges,
                       ScanLineMessage* message) {
  switch (kind) {
    case MessageKind::kLaserScan:
      return ReadLaserScan(reader, with_ranges, message);
    case MessageKind::kMultiEchoLaserScan:
      return ReadMultiEchoLaserScan(reader, with_ranges, message);
    case MessageKind::kPointCloud2:
      return ReadPointCloud2(reader, with_ranges, message);
    default:
      return false;
  }
}

// False where the topic's messages are not serialised by ROS, or this one is not.
bool OpenRosMessage(const RecordingTopic& topic, ByteView data, SerialReader* reader) {
  if (topic.encoding == MessageEncoding::kCdr) return SerialReader::ForCdr(data, reader);
  *reader = SerialReader::ForRos1(data);
  return topic.encoding == MessageEncoding::kRos1;
}

}  // namespace

MessageKind KindOf(const RecordingTopic& topic) {
  if (topic.encoding == MessageEncoding::kCarmen) return CarmenKindOf(topic.type);
  if (topic.encoding == MessageEncoding::kUnknown) return MessageKind::kOther;
  const std::string type = WithoutMsg(topic.type);
  for (const KnownType& known : kKnownTypes) {
    if (type != known.type) continue;
    const bool is_same = topic.definition.empty() || topic.definition == known.ros1_definition;
    return is_same ? known.kind : MessageKind::kOther;
  }
  return MessageKind::kOther;
}

bool DecodeScanLine(const RecordingTopic& topic,
                    ByteView data,
                    bool with_ranges,
                    ScanLineMessage* message) {
  message->ranges.clear();
  message->angles.clear();
  message->is_planar = true;
  if (topic.encoding == MessageEncoding::kCarmen) {
    return ReadCarmenScanLine(data, with_ranges, message);
  }
  SerialReader reader;
  return OpenRosMessage(topic, data, &reader) &&
         DecodeRosScanLine(topic.kind, reader, with_ranges, message);
}

bool DecodeOdometry(const RecordingTopic& topic, ByteView data, OdometryMessage* message) {
  if (topic.encoding == MessageEncoding::kCarmen) return ReadCarmenOdometry(data, message);
  SerialReader reader;
  return OpenRosMessage(topic, data, &reader) && ReadOdometry(reader, message);
}

bool DecodeImu(const RecordingTopic& topic, ByteView data, ImuMessage* message) {
  SerialReader reader;
  return OpenRosMessage(topic, data, &reader) && ReadImu(reader, message);
}

bool DecodeJoints(const RecordingTopic& topic,
                  ByteView data,
                  uint64_t receipt_ns,
                  JointMessage* message) {
  SerialReader reader;
  if (!OpenRosMessage(topic, data, &reader)) return false;
  if (topic.kind == MessageKind::kJoints) return ReadJoints(reader, message);
  message->stamp_ns = static_cast<int64_t>(receipt_ns);
  return ReadNumber(reader, message);
}

bool DecodeImage(const RecordingTopic& topic, ByteView data, ImageMessage* message) {
  SerialReader reader;
  return OpenRosMessage(topic, data, &reader) && ReadImage(reader, message);
}

bool DecodeCameraInfo(const RecordingTopic& topic, ByteView data, CameraInfoMessage* message) {
  SerialReader reader;
  return OpenRosMessage(topic, data, &reader) && ReadCameraInfo(reader, message);
}

bool DecodeTransforms(const RecordingTopic& topic,
                      ByteView data,
                      std::vector<Transform>* transforms) {
  SerialReader reader;
  return OpenRosMessage(topic, data, &reader) && ReadTransforms(reader, transforms);
}

}  // namespace plumbline
