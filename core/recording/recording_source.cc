#include "core/recording/recording_source.h"

#include <utility>

#include "core/recording/decode.h"
#include "core/util/error.h"

namespace plumbline {

const char kRecordingFormats[] =
    "ROS 1 bag (.bag), ROS 2 recording (.mcap, .db3, or its folder), CARMEN log (.clf, .log), "
    "each also packed (.bz2, .zstd)";
const char kScanLineTypes[] =
    "sensor_msgs/LaserScan, sensor_msgs/MultiEchoLaserScan or sensor_msgs/PointCloud2";

RecordingSource::RecordingSource(std::unique_ptr<MessageFile> file,
                                 std::vector<std::string> warnings)
    : file_(std::move(file)), warnings_(std::move(warnings)) {}

void RecordingSource::Visit(const RecordingVisitor& visitor) {
  const auto wants = [&](const RecordingTopic& topic) {
    return visitor.wants == nullptr || visitor.wants(topic);
  };
  ScanLineMessage scan_line;
  OdometryMessage odometry;
  const auto visit = [&](const MessageRef& message, ByteView data) {
    const RecordingTopic& topic = topics()[message.topic_index];
    bool decoded = true;
    if (topic.HasScanLines() && visitor.scan_line != nullptr) {
      decoded = DecodeScanLine(topic, data, visitor.with_ranges, &scan_line);
      if (decoded) visitor.scan_line(message, scan_line);
    } else if (topic.HasOdometry() && visitor.odometry != nullptr) {
      decoded = DecodeOdometry(topic, data, &odometry);
      if (decoded) visitor.odometry(message, odometry);
    }
    if (!decoded && visitor.undecodable != nullptr) visitor.undecodable(message);
    return decoded;
  };
  file_->Scan(wants, visit);
  warnings_.insert(warnings_.end(), file_->warnings().begin(), file_->warnings().end());
}

void RecordingSource::ReadScanLine(const MessageRef& message, ScanLineMessage* scan_line) {
  const RecordingTopic& topic = topics()[message.topic_index];
  if (!DecodeScanLine(topic, file_->Read(message), true, scan_line)) {
    throw Error(path() + ": has changed while it was read");
  }
}

}  // namespace plumbline
