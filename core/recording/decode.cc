#include "core/recording/decode.h"

#include <string>

#include "core/recording/ros1_messages.h"

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
    {"nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7", MessageKind::kOdometry},
};

// ROS 2 writes "sensor_msgs/msg/LaserScan".
std::string WithoutMsg(const std::string& type) {
  const size_t at = type.find("/msg/");
  return at == std::string::npos ? type : type.substr(0, at) + type.substr(at + 4);
}

}  // namespace

MessageKind KindOf(const RecordingTopic& topic) {
  if (topic.encoding != MessageEncoding::kRos1) return MessageKind::kOther;
  const std::string type = WithoutMsg(topic.type);
  for (const KnownType& known : kKnownTypes) {
    if (type == known.type && topic.definition == known.ros1_definition) return known.kind;
  }
  return MessageKind::kOther;
}

bool DecodeScanLine(const RecordingTopic& topic,
                    ByteView data,
                    bool with_ranges,
                    ScanLineMessage* message) {
  message->ranges.clear();
  message->angles.clear();
  message->time_offsets_s.clear();
  switch (topic.encoding) {
    case MessageEncoding::kRos1:
      return ReadRos1ScanLine(data, topic.kind, with_ranges, message);
    default:
      return false;
  }
}

bool DecodeOdometry(const RecordingTopic& topic, ByteView data, OdometryMessage* message) {
  switch (topic.encoding) {
    case MessageEncoding::kRos1:
      return ReadRos1Odometry(data, message);
    default:
      return false;
  }
}

}  // namespace plumbline
