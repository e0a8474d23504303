#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/recording/byte_source.h"

namespace plumbline {

// How the bytes of a message are to be read.
enum class MessageEncoding { kRos1, kCdr, kCarmen, kUnknown };

// The kind of a message for the program. In a CARMEN log, a laser's line is a laser scan and
// ODOM is odometry.
enum class MessageKind {
  kOther,
  kLaserScan,
  kMultiEchoLaserScan,
  kPointCloud2,
  kOdometry,
  kImu,
  kJoints,
  kNumber,
  kTransforms,
  kImage,
  kCameraInfo
};

// RecordingTopic is what one publisher of one topic has left in a recording.
struct RecordingTopic {
  std::string name;
  std::string type;        // as the recording names it, such as "sensor_msgs/LaserScan"
  std::string definition;  // of the type: ROS 1's md5sum; empty where the format has none
  MessageEncoding encoding = MessageEncoding::kUnknown;
  MessageKind kind = MessageKind::kOther;
  uint64_t num_messages = 0;  // that were found, readable or not
  // Whether messages of another kind state the pose by odometry as well, as the scan lines of
  // a CARMEN log do.
  bool also_has_odometry = false;

  bool HasOdometry() const { return kind == MessageKind::kOdometry || also_has_odometry; }
  // Transforms between frames, such as those of /tf_static.
  bool HasTransforms() const { return kind == MessageKind::kTransforms; }
  bool HasImu() const { return kind == MessageKind::kImu; }
  // The angles of joints, or a number that may be one.
  bool HasJoints() const {
    return kind == MessageKind::kJoints || kind == MessageKind::kNumber;
  }
  bool HasImages() const { return kind == MessageKind::kImage; }
  bool HasCameraInfos() const { return kind == MessageKind::kCameraInfo; }
  bool HasScanLines() const {
    return kind == MessageKind::kLaserScan || kind == MessageKind::kMultiEchoLaserScan ||
           kind == MessageKind::kPointCloud2;
  }
};

// MessageRef says where a message of a recording is. Only the file's format knows what the
// last three numbers mean.
struct MessageRef {
  uint64_t receipt_ns = 0;   // when the recorder received it, since 1970
  uint32_t topic_index = 0;  // in topics()
  uint32_t size = 0;         // of its data, bytes
  uint32_t part = 0;         // chunk or file
  uint64_t begin = 0;        // of its data in the part, or its row there
};

// MessageFile is a recording of one format as a sequence of messages whose bytes are not yet
// understood. It need not be what it claims: every length is held against what there is, and
// what can not be read is passed over, counted and told by warnings(). Memory: an index of the
// messages that the caller keeps, and a few chunks.
class MessageFile {
 public:
  virtual ~MessageFile() = default;

  virtual const std::string& path() const = 0;
  // The format in words, such as "ROS 1 bag".
  virtual std::string format() const = 0;

  // Says whether the messages of a topic are to be visited. Its num_messages are not yet
  // known.
  using Wants = std::function<bool(const RecordingTopic&)>;
  // Takes a message and its data, valid during the call only; false where the data make no
  // sense.
  using Visit = std::function<bool(const MessageRef&, ByteView)>;

  // Goes through the whole recording, once. Visits the messages in the order of the file.
  // Throws Error that names the file where nothing can be read at all.
  virtual void Scan(const Wants& wants, const Visit& visit) = 0;

  // Returns the topics found by Scan(). Several may have the same name: one for each
  // publisher.
  virtual const std::vector<RecordingTopic>& topics() const = 0;
  // The data of a visited message, valid until the next call. Throws Error when the file has
  // changed since.
  virtual ByteView Read(const MessageRef& message) = 0;
  // Sentences for the user about what is damaged or missing, after Scan().
  virtual const std::vector<std::string>& warnings() const = 0;
};

}  // namespace plumbline
