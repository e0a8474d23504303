#include "core/recording/recording_source.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/recording/decode.h"
#include "core/recording/segment_joiner.h"
#include "core/recording/unpack.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

std::tuple<uint32_t, uint64_t, uint32_t> KeyOf(const MessageRef& message) {
  return {message.part, message.begin, message.topic_index};
}

}  // namespace

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
  ImuMessage imu;
  JointMessage joints;
  std::vector<Transform> transforms;
  ImageMessage image;
  CameraInfoMessage camera_info;
  SegmentJoiner joiner([&](const std::vector<MessageRef>& parts, const ScanLineMessage& line) {
    const MessageRef& first = parts.front();
    if (parts.size() > 1) segments_[KeyOf(first)].assign(parts.begin() + 1, parts.end());
    visitor.scan_line(first, line);
  });
  const auto visit = [&](const MessageRef& message, ByteView stored) {
    const RecordingTopic& topic = topics()[message.topic_index];
    const ByteView data = Unpacked(topic, stored);
    bool decoded = true;
    if (topic.HasScanLines() && visitor.scan_line != nullptr) {
      decoded = DecodeScanLine(topic, data, visitor.with_ranges, &scan_line);
      if (decoded) joiner.Add(message, scan_line);
    }
    if (decoded && topic.HasOdometry() && visitor.odometry != nullptr) {
      decoded = DecodeOdometry(topic, data, &odometry);
      if (decoded) visitor.odometry(message, odometry);
    }
    if (topic.HasImu() && visitor.imu != nullptr) {
      decoded = DecodeImu(topic, data, &imu);
      if (decoded) visitor.imu(message, imu);
    }
    if (topic.HasJoints() && visitor.joints != nullptr) {
      decoded = DecodeJoints(topic, data, message.receipt_ns, &joints);
      if (decoded) visitor.joints(message, joints);
    }
    if (topic.HasTransforms() && visitor.transforms != nullptr) {
      decoded = DecodeTransforms(topic, data, &transforms);
      if (decoded) visitor.transforms(message, transforms);
    }
    if (topic.HasImages() && visitor.image != nullptr) {
      decoded = DecodeImage(topic, data, &image);
      if (decoded) visitor.image(message, image);
    }
    if (topic.HasCameraInfos() && visitor.camera_info != nullptr) {
      decoded = DecodeCameraInfo(topic, data, &camera_info);
      if (decoded) visitor.camera_info(message, camera_info);
    }
    if (!decoded && visitor.undecodable != nullptr) visitor.undecodable(message);
    return decoded;
  };
  file_->Scan(wants, visit);
  joiner.Finish();
  warnings_.insert(warnings_.end(), file_->warnings().begin(), file_->warnings().end());
}

// rosbag2 can pack each message on its own. No CDR begins as what zstd packs does.
ByteView RecordingSource::Unpacked(const RecordingTopic& topic, ByteView data) {
  constexpr uint8_t kZstdMagic[] = {0x28, 0xb5, 0x2f, 0xfd};
  if (topic.encoding != MessageEncoding::kCdr || data.size < sizeof(kZstdMagic) ||
      !std::equal(std::begin(kZstdMagic), std::end(kZstdMagic), data.data)) {
    return data;
  }
  MemorySource packed(data);
  uint64_t num_taken = 0;
  Unpack("zstd", &packed, 0, &unpacked_, &num_taken);
  return {unpacked_.data(), unpacked_.size()};  // where it is damaged, it can not be decoded
}

void RecordingSource::DecodeAgain(const MessageRef& message, ScanLineMessage* scan_line) {
  const RecordingTopic& topic = topics()[message.topic_index];
  if (!DecodeScanLine(topic, Unpacked(topic, file_->Read(message)), true, scan_line)) {
    throw Error(path() + ": has changed while it was read");
  }
}

void RecordingSource::ReadScanLine(const MessageRef& message, ScanLineMessage* scan_line) {
  DecodeAgain(message, scan_line);
  const auto segments = segments_.find(KeyOf(message));
  if (segments == segments_.end()) return;
  for (const MessageRef& part : segments->second) {
    DecodeAgain(part, &segment_);
    AppendSegment(segment_, scan_line);
  }
}

void RecordingSource::ReadImage(const MessageRef& message, ImageMessage* image) {
  const RecordingTopic& topic = topics()[message.topic_index];
  if (!DecodeImage(topic, Unpacked(topic, file_->Read(message)), image)) {
    throw Error(path() + ": has changed while it was read");
  }
}

}  // namespace plumbline
