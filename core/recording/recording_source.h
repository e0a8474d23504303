#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "core/recording/message_file.h"
#include "core/recording/messages.h"

namespace plumbline {

// RecordingVisitor says what of a recording is wanted, and takes it. Functions that are not
// set are not called, and what they would get is not decoded.
struct RecordingVisitor {
  // Whether a topic's messages are visited; all are where it is not set. Called once for each
  // of RecordingSource::topics(), in their order, before the topic's first message.
  std::function<bool(const RecordingTopic&)> wants;
  // Messages are valid during the call only. A revolution that a scanner sends in several
  // messages is one scan line (segment_joiner.h), of its first message.
  std::function<void(const MessageRef&, const ScanLineMessage&)> scan_line;
  // Also of topics whose scan lines state odometry as well.
  std::function<void(const MessageRef&, const OdometryMessage&)> odometry;
  std::function<void(const MessageRef&, const ImuMessage&)> imu;
  std::function<void(const MessageRef&, const JointMessage&)> joints;
  std::function<void(const MessageRef&, const std::vector<Transform>&)> transforms;
  std::function<void(const MessageRef&, const ImageMessage&)> image;
  std::function<void(const MessageRef&, const CameraInfoMessage&)> camera_info;
  // A message of a wanted topic that can not be decoded.
  std::function<void(const MessageRef&)> undecodable;
  bool with_ranges = true;  // false: scan lines without ranges, which is faster
};

// RecordingSource is a recording of any format that OpenRecording() knows, as scan lines and
// odometry. It knows no rig: any topic can be read.
class RecordingSource {
 public:
  // warnings: what has been noticed while it was opened.
  explicit RecordingSource(std::unique_ptr<MessageFile> file,
                           std::vector<std::string> warnings = {});

  const std::string& path() const { return file_->path(); }
  std::string format() const { return file_->format(); }  // such as "ROS 1 bag"

  // Goes through the whole recording, once, in the order of the file. Throws Error that names
  // the file where nothing can be read at all.
  void Visit(const RecordingVisitor& visitor);

  // Returns the topics found by Visit(), also those that nobody wanted. Several may have the
  // same name: one for each publisher.
  const std::vector<RecordingTopic>& topics() const { return file_->topics(); }
  // Reads a visited scan line again, with ranges. Throws Error when the file has changed
  // since.
  void ReadScanLine(const MessageRef& message, ScanLineMessage* scan_line);
  // Reads a visited image again; its data are valid until the next call.
  void ReadImage(const MessageRef& message, ImageMessage* image);
  // Sentences for the user about what is damaged or missing, after Visit().
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  ByteView Unpacked(const RecordingTopic& topic, ByteView data);
  void DecodeAgain(const MessageRef& message, ScanLineMessage* scan_line);

  std::unique_ptr<MessageFile> file_;
  std::vector<uint8_t> unpacked_;  // the last message that was packed on its own
  // Places of the first message of a revolution (part, begin, topic) and of its other
  // messages.
  std::map<std::tuple<uint32_t, uint64_t, uint32_t>, std::vector<MessageRef>> segments_;
  ScanLineMessage segment_;  // read last
  std::vector<std::string> warnings_;
};

// Opens a recording; its format is found from its first bytes, not its name. A folder is a
// rosbag2 recording. Throws Error that names the file, and says what it looks like, when it is
// none that can be read.
std::unique_ptr<RecordingSource> OpenRecording(const std::string& path);

// The formats, and the types of messages with scan lines, that are read: for help texts and
// errors.
extern const char kRecordingFormats[];
extern const char kScanLineTypes[];

}  // namespace plumbline
