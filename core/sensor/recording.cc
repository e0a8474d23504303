#include "core/sensor/recording.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "core/recording/recording_source.h"
#include "core/sensor/depth_camera_collector.h"
#include "core/sensor/mount_collector.h"
#include "core/sensor/odometry_collector.h"
#include "core/sensor/recording_words.h"
#include "core/sensor/scan_header.h"
#include "core/sensor/scan_order.h"
#include "core/util/error.h"
#include "core/util/one_line.h"
#include "core/util/time.h"

namespace plumbline {

namespace {

// Largest number of scan lines that the reader holds back while it brings messages into the
// order of their stamps, a few MB; beyond that it fetches single messages out of turn.
constexpr size_t kMaxBufferedScanLines = 512;

// The directions of a scanner's beams. Its lines hardly ever differ in their angles.
class KnownDirections {
 public:
  // irregular: of each beam; empty where they are regular.
  void SetOf(const std::vector<float>& irregular, ScanLine* scan_line) {
    const bool is_known = directions_ != nullptr && scan_line->angle_min == angle_min_ &&
                          scan_line->angle_increment == angle_increment_ &&
                          irregular == irregular_ &&
                          directions_->size() >= scan_line->ranges.size();
    if (!is_known) Compute(irregular, scan_line);
    scan_line->directions = directions_;
    scan_line->angles = angles_;
  }

 private:
  void Compute(const std::vector<float>& irregular, ScanLine* scan_line) {
    angle_min_ = scan_line->angle_min;
    angle_increment_ = scan_line->angle_increment;
    irregular_ = irregular;
    angles_ = nullptr;
    if (!irregular.empty()) {
      angles_ = std::make_shared<std::vector<double>>(irregular.begin(), irregular.end());
    }
    scan_line->angles = angles_;
    scan_line->directions = nullptr;  // the last line's
    auto directions = std::make_shared<std::vector<Eigen::Vector2d>>();
    for (int beam = 0; beam < scan_line->num_beams(); ++beam) {
      directions->push_back(scan_line->BeamDirection(beam));
    }
    directions_ = std::move(directions);
  }

  double angle_min_ = 0.0;
  double angle_increment_ = 0.0;
  std::vector<float> irregular_;
  std::shared_ptr<const std::vector<double>> angles_;
  std::shared_ptr<const std::vector<Eigen::Vector2d>> directions_;
};

bool IsImu(const Rig& rig, const RecordingTopic& topic) {
  return rig.imu && topic.HasImu() && topic.name == rig.imu->topic;
}

}  // namespace

struct RecordingReader::Impl {
  Impl(const std::string& path, const Rig& rig)
      : source(OpenRecording(path)),
        scanners(rig.scanners),
        wheels(rig),
        mounts(rig),
        cameras(rig) {}

  std::unique_ptr<RecordingSource> source;
  std::vector<Scanner> scanners;
  std::vector<MessageRef> messages;  // by position: in the order of their receipt
  std::vector<ScanStamp> stamps;     // by position
  std::vector<int64_t> orders;       // by position; -1: passed over
  ScanOrder order;
  std::vector<LostMessages> undecodable;  // by scanner
  std::vector<LostMessages> off_plane;    // by scanner
  std::vector<int> num_without_times;     // by scanner: messages whose time_increment is 0
  std::vector<std::string> unusable_reasons;  // by scanner: of the first such message
  OdometryCollector wheels;               // what they say, while it is read
  std::shared_ptr<const Odometry> odometry;
  std::string odometry_fault;
  std::vector<std::string> odometry_mended;  // what has been, in sentences
  int num_odometry_lost = 0;  // messages that can not be decoded
  std::vector<ImuSample> imu_samples;
  std::shared_ptr<const ImuReadings> imu;
  std::string imu_fault;
  LostMessages imu_lost;  // that can not be decoded
  MountCollector mounts;  // what tells how these turn
  DepthCameraCollector cameras;
  std::vector<std::string> warnings;

  // State of the reading.
  size_t next_order = 0;
  size_t next_position = 0;
  std::map<size_t, ScanLine> buffer;        // by order: read ahead of their turn
  std::vector<KnownDirections> directions;  // by scanner
  ScanLineMessage message;                  // read last

  const std::string& path() const { return source->path(); }
  void CheckTopics(const Rig& rig);
  std::map<std::string, int> IndicesByTopic(const Rig& rig) const;
  void IndexMessages(const Rig& rig, const RecordingObserver& observer);
  void IndexScanLine(int scanner_index, const MessageRef& ref, ScanLineMessage scan);
  void CountLost(const Rig& rig, const MessageRef& ref);
  void OrderMessages(const Rig& rig);
  void TakeOdometry(const Rig& rig);
  void TakeImu(const Rig& rig);
  void SortByReceipt();
  void CollectWarnings(const Rig& rig);
  std::string DamageText() const;
  bool Next(ScanLine* scan_line);
  void ReadAhead(size_t position);
  void ReadScanLine(size_t position, ScanLine* scan_line);
  void ReadMessage(size_t position);
};

// Returns the damage of the recording, as the end of an error that may come from it.
std::string RecordingReader::Impl::DamageText() const {
  std::string text;
  for (const std::string& warning : source->warnings()) text += "; " + warning;
  return text;
}

// Every topic of the rig must be there once and carry scan lines.
void RecordingReader::Impl::CheckTopics(const Rig& rig) {
  std::multimap<std::string, const RecordingTopic*> topics;
  std::set<std::string> scan_topics;
  for (const RecordingTopic& topic : source->topics()) {
    topics.emplace(topic.name, &topic);
    if (topic.HasScanLines()) scan_topics.insert(topic.name);
  }
  const std::string hint =
      "; topics with laser scans in this recording:" + TopicsText(scan_topics) + DamageText();

  for (const Scanner& scanner : rig.scanners) {
    if (scanner.camera_row) continue;
    const auto [begin, end] = topics.equal_range(scanner.topic);
    if (begin == end) {
      throw Error(path() + ": has no topic " + Shown(scanner.topic) + " (scanner " +
                  Quoted(scanner.name) + " of the rig)" + hint);
    }
    for (auto topic = begin; topic != end; ++topic) {
      if (topic->second->HasScanLines()) continue;
      const std::string& definition = topic->second->definition;
      throw Error(path() + ": topic " + Shown(scanner.topic) + " (scanner " +
                  Quoted(scanner.name) + " of the rig) is of type " +
                  Shown(topic->second->type) +
                  (definition.empty() ? "" : " (definition " + Shown(definition) + ")") +
                  ", not " + kScanLineTypes + hint);
    }
  }
}

// Positions of the rig's scanners by topic.
std::map<std::string, int> RecordingReader::Impl::IndicesByTopic(const Rig& rig) const {
  std::map<std::string, int> scanner_indices;
  for (const Scanner& scanner : rig.scanners) {
    if (scanner.camera_row) continue;
    const auto [known, is_new] =
        scanner_indices.emplace(scanner.topic, static_cast<int>(scanner_indices.size()));
    if (is_new) continue;
    throw Error(path() + ": scanners " +
                Quoted(rig.scanners[static_cast<size_t>(known->second)].name) + " and " +
                Quoted(scanner.name) + " of the rig name the same topic " +
                Shown(scanner.topic));
  }
  return scanner_indices;
}

// First pass: stamps and heads only, unless somebody watches.
void RecordingReader::Impl::IndexMessages(const Rig& rig, const RecordingObserver& observer) {
  const std::map<std::string, int> scanner_indices = IndicesByTopic(rig);
  undecodable.resize(rig.scanners.size());
  off_plane.resize(rig.scanners.size());
  num_without_times.resize(rig.scanners.size(), 0);
  unusable_reasons.resize(rig.scanners.size());
  const auto scanner_of = [&](const MessageRef& ref) {
    return scanner_indices.at(source->topics()[ref.topic_index].name);
  };
  RecordingVisitor visitor;
  visitor.with_ranges = observer.scan_line != nullptr;
  visitor.wants = [&](const RecordingTopic& topic) {
    return (topic.HasScanLines() && scanner_indices.count(topic.name) > 0) ||
           (topic.HasOdometry() && topic.name == rig.odometry_topic) || IsImu(rig, topic) ||
           mounts.Wants(topic) || cameras.Wants(topic);
  };
  visitor.camera_info = [&](const MessageRef& ref, const CameraInfoMessage& message) {
    cameras.Add(source->topics()[ref.topic_index], message);
  };
  visitor.image = [&](const MessageRef& ref, const ImageMessage& image) {
    for (const int scanner : cameras.Add(source->topics()[ref.topic_index], image)) {
      messages.push_back(ref);
      stamps.push_back({image.stamp_ns, scanner, true, static_cast<int64_t>(ref.receipt_ns)});
    }
  };
  visitor.joints = [&](const MessageRef& ref, const JointMessage& message) {
    mounts.Add(source->topics()[ref.topic_index], message);
  };
  visitor.imu = [&](const MessageRef&, const ImuMessage& message) {
    if (!message.has_angular_velocity || !message.has_linear_acceleration) return;
    imu_samples.push_back({message.stamp_ns + NanosecondsFromSeconds(rig.imu->time_offset_s),
                           Eigen::Vector3d(message.angular_velocity.data()),
                           Eigen::Vector3d(message.linear_acceleration.data())});
  };
  visitor.odometry = [&](const MessageRef& ref, const OdometryMessage& message) {
    if (source->topics()[ref.topic_index].name == rig.odometry_topic) wheels.Add(message);
  };
  visitor.scan_line = [&](const MessageRef& ref, const ScanLineMessage& as_sent) {
    if (scanner_indices.count(source->topics()[ref.topic_index].name) == 0) return;
    if (observer.scan_line != nullptr) {
      observer.scan_line(source->topics()[ref.topic_index], ref, as_sent);
    }
    IndexScanLine(scanner_of(ref), ref, as_sent);
  };
  visitor.undecodable = [&](const MessageRef& ref) {
    if (scanner_indices.count(source->topics()[ref.topic_index].name) == 0) {
      CountLost(rig, ref);
      return;
    }
    undecodable[static_cast<size_t>(scanner_of(ref))].Add(ref);
    if (observer.undecodable != nullptr) {
      observer.undecodable(source->topics()[ref.topic_index]);
    }
  };
  source->Visit(visitor);
  CheckTopics(rig);
  TakeOdometry(rig);
  TakeImu(rig);
  mounts.Finish(path(), source->topics(), DamageText());
  cameras.Finish(path(), source->topics(), DamageText());
  OrderMessages(rig);
}

void RecordingReader::Impl::IndexScanLine(int scanner_index,
                                          const MessageRef& ref,
                                          ScanLineMessage scan) {
  const auto at = static_cast<size_t>(scanner_index);
  CorrectHeader(&scanners[at], &scan);
  if (!scan.is_planar) {
    off_plane[at].Add(ref);
    return;
  }
  if (scan.angles.empty() && scan.num_beams > 1 && scan.time_increment == 0.0f) {
    ++num_without_times[at];
  }
  if (unusable_reasons[at].empty() && !scan.IsUsable()) {
    unusable_reasons[at] = WhyUnusable(scan);
  }
  messages.push_back(ref);
  stamps.push_back(
      {scan.stamp_ns, scanner_index, scan.IsUsable(), static_cast<int64_t>(ref.receipt_ns)});
}

// Counts a message that can not be decoded and is no scanner's.
void RecordingReader::Impl::CountLost(const Rig& rig, const MessageRef& ref) {
  const RecordingTopic& topic = source->topics()[ref.topic_index];
  if (IsImu(rig, topic)) {
    imu_lost.Add(ref);
  } else if (mounts.Wants(topic)) {
    mounts.AddLost(topic, ref);
  } else if (cameras.Wants(topic)) {
    cameras.AddLost(topic, ref);
  } else {
    ++num_odometry_lost;
  }
}

// Brings the scan lines into the order in which they are read.
void RecordingReader::Impl::OrderMessages(const Rig& rig) {
  SortByReceipt();
  order = OrderScanLines(rig, stamps, unusable_reasons);
  order.positions.erase(std::remove_if(order.positions.begin(),
                                       order.positions.end(),
                                       [&](size_t position) {
                                         return mounts.PassesOver(
                                             stamps[position].scanner_index,
                                             stamps[position].stamp_ns,
                                             order.scan_period_s);
                                       }),
                        order.positions.end());
  orders.assign(stamps.size(), -1);
  for (size_t i = 0; i < order.positions.size(); ++i) {
    orders[order.positions[i]] = static_cast<int64_t>(i);
  }
}

// The topic that the rig names must be there and carry odometry.
void RecordingReader::Impl::TakeOdometry(const Rig& rig) {
  if (rig.odometry_topic.empty()) return;
  std::set<std::string> topics;
  for (const RecordingTopic& topic : source->topics()) {
    if (topic.HasOdometry()) topics.insert(topic.name);
  }
  if (topics.count(rig.odometry_topic) == 0) {
    throw Error(path() + ": has no odometry in topic " + Shown(rig.odometry_topic) +
                " that the rig names; topics with odometry in this recording:" +
                TopicsText(topics) + DamageText());
  }
  odometry_fault = wheels.Fault();
  odometry = wheels.Finish(&odometry_mended);
}

// The topic that the rig names must be there and carry an IMU's messages.
void RecordingReader::Impl::TakeImu(const Rig& rig) {
  if (!rig.imu) return;
  std::set<std::string> topics;
  for (const RecordingTopic& topic : source->topics()) {
    if (topic.HasImu()) topics.insert(topic.name);
  }
  if (topics.count(rig.imu->topic) == 0) {
    throw Error(path() + ": has no sensor_msgs/Imu in topic " + Shown(rig.imu->topic) +
                " that the rig names; topics with IMUs in this recording:" +
                TopicsText(topics) + DamageText());
  }
  auto readings = std::make_shared<const ImuReadings>(std::move(imu_samples), *rig.imu);
  imu_fault = readings->Fault();
  if (imu_fault.empty()) imu = std::move(readings);
}

// Recorders write what they receive in turn, but tools that cut and join bags need not.
void RecordingReader::Impl::SortByReceipt() {
  const auto earlier = [](const MessageRef& a, const MessageRef& b) {
    return a.receipt_ns < b.receipt_ns;
  };
  if (std::is_sorted(messages.begin(), messages.end(), earlier)) return;
  std::vector<size_t> indices(messages.size());
  for (size_t i = 0; i < indices.size(); ++i) indices[i] = i;
  std::stable_sort(indices.begin(), indices.end(), [&](size_t a, size_t b) {
    return earlier(messages[a], messages[b]);
  });
  std::vector<MessageRef> sorted_messages;
  std::vector<ScanStamp> sorted_stamps;
  for (size_t index : indices) {
    sorted_messages.push_back(messages[index]);
    sorted_stamps.push_back(stamps[index]);
  }
  messages = std::move(sorted_messages);
  stamps = std::move(sorted_stamps);
}

void RecordingReader::Impl::CollectWarnings(const Rig& rig) {
  warnings = source->warnings();
  for (size_t i = 0; i < rig.scanners.size(); ++i) {
    const std::string& name = rig.scanners[i].name;
    const std::string scanner = "scanner " + Quoted(name);
    undecodable[i].WarnOf(scanner, "that can not be decoded", &warnings);
    off_plane[i].WarnOf(
        scanner, "whose points do not lie in one scan plane, z = 0 in their frame", &warnings);
    if (num_without_times[i] == 0) continue;
    warnings.push_back("scanner '" + OnOneLine(name) + "': time_increment is 0 in " +
                       std::to_string(num_without_times[i]) +
                       (num_without_times[i] == 1 ? " message" : " messages") +
                       ": all beams of a scan line count as measured at once; "
                       "time_increment_s in the rig file replaces it");
  }
  if (!odometry_fault.empty()) {
    warnings.push_back("odometry is left out: " + odometry_fault);
  }
  for (const std::string& mended : odometry_mended) warnings.push_back("odometry: " + mended);
  if (num_odometry_lost > 0) {
    warnings.push_back("odometry: " + std::to_string(num_odometry_lost) +
                       (num_odometry_lost == 1 ? " message is lost" : " messages are lost") +
                       " that can not be decoded");
  }
  if (!imu_fault.empty()) warnings.push_back("the IMU is left out: " + imu_fault);
  imu_lost.WarnOf("the IMU", "that can not be decoded", &warnings);
  mounts.AddWarnings(&warnings);
  cameras.AddWarnings(&warnings);
  for (const std::string& warning : order.warnings) warnings.push_back(OnOneLine(warning));
  if (!order.positions.empty()) return;
  std::string reasons;
  for (const std::string& warning : warnings) reasons += "; " + warning;
  throw Error(path() + ": has no scan lines of the rig's scanners" + reasons);
}

void RecordingReader::Impl::ReadMessage(size_t position) {
  const int scanner = stamps[position].scanner_index;
  if (cameras.IsRow(scanner)) {
    cameras.ReadRow(scanner, messages[position], source.get(), &message);
  } else {
    source->ReadScanLine(messages[position], &message);
    CorrectHeader(&scanners[static_cast<size_t>(scanner)], &message);
  }
}

void RecordingReader::Impl::ReadScanLine(size_t position, ScanLine* scan_line) {
  std::swap(message.ranges, scan_line->ranges);  // whose memory is used again
  ReadMessage(position);
  if (message.stamp_ns != stamps[position].stamp_ns) {
    throw Error(path() + ": has changed while it was read");
  }
  const auto scanner = static_cast<size_t>(stamps[position].scanner_index);
  const auto bias = static_cast<float>(scanners[scanner].range_bias_m);
  const auto scale = static_cast<float>(scanners[scanner].range_scale);
  for (float& range : message.ranges) {
    if (IsStatedLimit(message, range)) range = std::numeric_limits<float>::quiet_NaN();
    range = (range - bias) * scale;
  }
  std::swap(message.ranges, scan_line->ranges);
  scan_line->scanner_index = stamps[position].scanner_index;
  scan_line->stamp_ns = message.stamp_ns;
  scan_line->angle_min = message.angle_min;
  scan_line->angle_increment = message.angle_increment;
  scan_line->time_increment_s = message.time_increment;
  directions[static_cast<size_t>(scan_line->scanner_index)].SetOf(message.angles, scan_line);
}

// Reads what comes in the bag up to and including position. Bag order is almost the order of
// stamps, and to go through the bag in its own order spares unpacking chunks twice.
void RecordingReader::Impl::ReadAhead(size_t position) {
  for (; next_position <= position; ++next_position) {
    if (orders[next_position] < static_cast<int64_t>(next_order)) continue;  // or passed over
    ReadScanLine(next_position, &buffer[static_cast<size_t>(orders[next_position])]);
  }
}

bool RecordingReader::Impl::Next(ScanLine* scan_line) {
  if (next_order == order.positions.size()) return false;
  const size_t position = order.positions[next_order];
  if (position > next_position &&
      buffer.size() + (position - next_position) <= kMaxBufferedScanLines) {
    ReadAhead(position - 1);
  }
  const auto buffered = buffer.find(next_order);
  if (buffered != buffer.end()) {
    std::swap(*scan_line, buffered->second);
    buffer.erase(buffered);
  } else {
    ReadScanLine(position, scan_line);
    if (position == next_position) ++next_position;
  }
  ++next_order;
  return true;
}

RecordingReader::RecordingReader(const std::string& path,
                                 const Rig& rig,
                                 const RecordingObserver& observer)
    : impl_(std::make_unique<Impl>(path, rig)) {
  impl_->directions.resize(rig.scanners.size());
  impl_->IndexMessages(rig, observer);
  impl_->CollectWarnings(rig);
}

RecordingReader::~RecordingReader() = default;

bool RecordingReader::Next(ScanLine* scan_line) { return impl_->Next(scan_line); }

void RecordingReader::Rewind() {
  impl_->next_order = 0;
  impl_->next_position = 0;
  impl_->buffer.clear();
}

int64_t RecordingReader::start_ns() const {
  return impl_->stamps[impl_->order.positions.front()].stamp_ns;
}

int64_t RecordingReader::end_ns() const {
  return impl_->stamps[impl_->order.positions.back()].stamp_ns;
}

const std::vector<RecordingTopic>& RecordingReader::topics() const {
  return impl_->source->topics();
}

int RecordingReader::num_scan_lines() const {
  return static_cast<int>(impl_->order.positions.size());
}

std::shared_ptr<const Odometry> RecordingReader::odometry() const { return impl_->odometry; }

void RecordingReader::DelayOdometry(double seconds) {
  impl_->odometry = std::make_shared<const Odometry>(impl_->odometry->Later(seconds));
}

const std::vector<std::shared_ptr<const JointAngles>>& RecordingReader::mount_angles() const {
  return impl_->mounts.angles();
}

void RecordingReader::PlaceCameras(Rig* rig) const { impl_->cameras.Place(rig); }

void PlaceScanners(const RecordingReader& recording, Rig* rig) {
  recording.PlaceCameras(rig);
  for (size_t i = 0; i < rig->scanners.size(); ++i) {
    if (!rig->scanners[i].mount) continue;
    rig->scanners[i].mount->start_ns = recording.start_ns();
    rig->scanners[i].mount->angles = recording.mount_angles()[i];
  }
}

std::shared_ptr<const ImuReadings> RecordingReader::imu() const { return impl_->imu; }

double RecordingReader::scan_period_s() const { return impl_->order.scan_period_s; }

const std::vector<std::string>& RecordingReader::warnings() const { return impl_->warnings; }

}  // namespace plumbline
