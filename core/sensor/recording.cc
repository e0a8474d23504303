#include "core/sensor/recording.h"

#include <glog/logging.h>
#include <rosbag/bag.h>
#include <rosbag/query.h>
#include <rosbag/view.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/MultiEchoLaserScan.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "core/sensor/scan_order.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"

namespace plumbline {

namespace {

namespace fs = std::filesystem;
namespace serialization = ros::serialization;

// The reader holds back at most so many scan lines while it brings messages into the order of
// their stamps, a few MB; beyond that it fetches single messages out of turn.
constexpr size_t kMaxBufferedScanLines = 512;

// Where rosbag copies the bytes of one serialized message to.
struct MessageBytes {
  std::vector<uint8_t> bytes;

  uint8_t* advance(uint32_t size) {
    bytes.resize(size);
    return bytes.data();
  }
};

// No scanner takes longer for a scan line. Infinity and NaN fail the comparison too.
constexpr float kMaxScanSeconds = 2.0f;

// The fields that LaserScan and MultiEchoLaserScan begin with.
struct ScanHead {
  int64_t stamp_ns = 0;
  float angle_min = 0.0f;
  float angle_increment = 0.0f;
  float time_increment = 0.0f;
  uint32_t num_beams = 0;

  bool IsUsable() const {
    return num_beams > 0 && std::isfinite(angle_min) && std::isfinite(angle_increment) &&
           angle_increment != 0.0f && time_increment >= 0.0f &&
           time_increment * static_cast<float>(num_beams) <= kMaxScanSeconds;
  }
};

ScanHead ReadHead(serialization::IStream* stream) {
  std_msgs::Header header;
  ScanHead head;
  float angle_max = 0.0f;
  float scan_time = 0.0f;
  float range_min = 0.0f;
  float range_max = 0.0f;
  stream->next(header);
  stream->next(head.angle_min);
  stream->next(angle_max);
  stream->next(head.angle_increment);
  stream->next(head.time_increment);
  stream->next(scan_time);
  stream->next(range_min);
  stream->next(range_max);
  stream->next(head.num_beams);
  head.stamp_ns = static_cast<int64_t>(header.stamp.toNSec());
  // Either type takes at least 4 bytes a beam. Checked here, before anybody allocates memory.
  if (head.num_beams > stream->getLength() / 4) {
    throw serialization::StreamOverrunException("message shorter than its number of beams");
  }
  return head;
}

// The directions of a scanner's beams. Its lines hardly ever differ in their angles.
class KnownDirections {
 public:
  void SetOf(ScanLine* scan_line) {
    if (directions_ == nullptr || scan_line->angle_min != angle_min_ ||
        scan_line->angle_increment != angle_increment_ ||
        directions_->size() < scan_line->ranges.size()) {
      angle_min_ = scan_line->angle_min;
      angle_increment_ = scan_line->angle_increment;
      scan_line->directions = nullptr;  // the last line's
      auto directions = std::make_shared<std::vector<Eigen::Vector2d>>();
      for (int beam = 0; beam < scan_line->num_beams(); ++beam) {
        directions->push_back(scan_line->BeamDirection(beam));
      }
      directions_ = std::move(directions);
    }
    scan_line->directions = directions_;
  }

 private:
  double angle_min_ = 0.0;
  double angle_increment_ = 0.0;
  std::shared_ptr<const std::vector<Eigen::Vector2d>> directions_;
};

void ReadRanges(bool multi_echo,
                uint32_t num_beams,
                serialization::IStream* stream,
                std::vector<float>* ranges) {
  ranges->resize(num_beams);
  if (!multi_echo) {
    if (num_beams == 0) return;
    std::memcpy(ranges->data(), stream->advance(num_beams * 4), num_beams * sizeof(float));
    return;
  }
  for (float& range : *ranges) {
    uint32_t num_echoes = 0;
    stream->next(num_echoes);
    if (num_echoes > stream->getLength() / 4) {
      throw serialization::StreamOverrunException("message shorter than its number of echoes");
    }
    range = std::numeric_limits<float>::quiet_NaN();
    if (num_echoes == 0) continue;
    std::memcpy(&range, stream->advance(num_echoes * 4), sizeof(float));
  }
}

std::string Quoted(const std::string& text) { return "'" + text + "'"; }

template <typename Message>
bool IsOfType(const rosbag::ConnectionInfo& connection) {
  return connection.datatype == ros::message_traits::DataType<Message>::value() &&
         connection.md5sum == ros::message_traits::MD5Sum<Message>::value();
}

bool IsScanType(const rosbag::ConnectionInfo& connection) {
  return IsOfType<sensor_msgs::LaserScan>(connection) ||
         IsOfType<sensor_msgs::MultiEchoLaserScan>(connection);
}

// Opens a bag or says in one line why it can not be read.
void OpenBag(const std::string& path, rosbag::Bag* bag) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) throw Error(path + ": no such file");
  if (!fs::is_regular_file(path, ignored)) throw Error(path + ": is not a file");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error(path + ": can not be read: " + std::strerror(errno));
  const std::string magic = "#ROSBAG V";
  std::string start(magic.size(), '\0');
  stream.read(start.data(), static_cast<std::streamsize>(start.size()));
  if (start != magic) throw Error(path + ": is not a ROS 1 bag");

  // rosbag reports through exceptions too; its own log would only repeat them.
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
  try {
    bag->open(path, rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    throw Error(path +
                ": the recording breaks off: the bag was never closed and has no index; " +
                "`rosbag reindex` may repair it");
  } catch (const std::exception& exception) {
    throw Error(path + ": the recording breaks off after " +
                std::to_string(fs::file_size(path, ignored)) + " bytes or is damaged (" +
                exception.what() + "); `rosbag reindex` may repair it");
  }
}

// Takes a bag that can not be closed, for want of space: its destructor would try again,
// throw, and so end the program. The list keeps it reachable.
void Abandon(std::unique_ptr<rosbag::Bag> bag) {
  static auto* abandoned = new std::vector<rosbag::Bag*>();
  abandoned->push_back(bag.release());
}

}  // namespace

struct RecordingReader::Impl {
  std::string path;
  rosbag::Bag bag;
  std::vector<rosbag::MessageInstance> instances;  // by position: the order of the bag
  std::vector<ScanStamp> stamps;                   // by position
  std::vector<int64_t> orders;                     // by position; -1: passed over
  ScanOrder order;

  // State of the reading.
  size_t next_order = 0;
  size_t next_position = 0;
  std::map<size_t, ScanLine> buffer;  // by order: read ahead of their turn
  MessageBytes bytes;
  std::vector<KnownDirections> directions;  // by scanner

  void CheckTopics(const Rig& rig);
  void IndexMessages(const Rig& rig);
  bool Next(ScanLine* scan_line);
  void ReadAhead(size_t position);

  [[noreturn]] void Fail(size_t position, const std::string& reason);
  serialization::IStream ReadBytes(size_t position);
  ScanHead ReadMessageHead(size_t position);
  void ReadScanLine(size_t position, ScanLine* scan_line);
};

void RecordingReader::Impl::Fail(size_t position, const std::string& reason) {
  const rosbag::MessageInstance& instance = instances[position];
  char time[32];
  std::snprintf(
      time, sizeof(time), "%u.%09u", instance.getTime().sec, instance.getTime().nsec);
  throw Error(path + ": message " + std::to_string(position + 1) + " of " +
              std::to_string(instances.size()) + " (topic " + instance.getTopic() +
              ", recorded at " + time + " s) can not be decoded: " + reason);
}

serialization::IStream RecordingReader::Impl::ReadBytes(size_t position) {
  bytes.bytes.clear();  // rosbag does not touch them where a message is empty
  instances[position].write(bytes);
  return {bytes.bytes.data(), static_cast<uint32_t>(bytes.bytes.size())};
}

ScanHead RecordingReader::Impl::ReadMessageHead(size_t position) {
  try {
    serialization::IStream stream = ReadBytes(position);
    return ReadHead(&stream);
  } catch (const std::exception& exception) {
    Fail(position, exception.what());
  }
}

void RecordingReader::Impl::ReadScanLine(size_t position, ScanLine* scan_line) {
  const bool multi_echo =
      instances[position].getDataType() ==
      ros::message_traits::DataType<sensor_msgs::MultiEchoLaserScan>::value();
  try {
    serialization::IStream stream = ReadBytes(position);
    const ScanHead head = ReadHead(&stream);
    scan_line->scanner_index = stamps[position].scanner_index;
    scan_line->stamp_ns = head.stamp_ns;
    scan_line->angle_min = head.angle_min;
    scan_line->angle_increment = head.angle_increment;
    scan_line->time_increment_s = head.time_increment;
    ReadRanges(multi_echo, head.num_beams, &stream, &scan_line->ranges);
    directions[static_cast<size_t>(scan_line->scanner_index)].SetOf(scan_line);
  } catch (const std::exception& exception) {
    Fail(position, exception.what());
  }
}

// Every topic of the rig must be there once and carry scan lines.
void RecordingReader::Impl::CheckTopics(const Rig& rig) {
  rosbag::View view(bag);
  std::multimap<std::string, const rosbag::ConnectionInfo*> connections;
  std::set<std::string> scan_topics;
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    connections.emplace(connection->topic, connection);
    if (IsScanType(*connection)) scan_topics.insert(connection->topic);
  }
  std::string listed;
  for (const std::string& topic : scan_topics) {
    listed += (listed.empty() ? " " : ", ") + topic;
  }
  if (listed.empty()) listed = " none";
  const std::string hint = "; topics with laser scans in this recording:" + listed;

  std::map<std::string, std::string> names;  // by topic
  for (const Scanner& scanner : rig.scanners) {
    if (!names.emplace(scanner.topic, scanner.name).second) {
      throw Error("scanners " + Quoted(names[scanner.topic]) + " and " + Quoted(scanner.name) +
                  " of the rig name the same topic " + scanner.topic);
    }
    const auto [begin, end] = connections.equal_range(scanner.topic);
    if (begin == end) {
      throw Error(path + ": has no topic " + scanner.topic + " (scanner " +
                  Quoted(scanner.name) + " of the rig)" + hint);
    }
    for (auto connection = begin; connection != end; ++connection) {
      if (IsScanType(*connection->second)) continue;
      throw Error(path + ": topic " + scanner.topic + " (scanner " + Quoted(scanner.name) +
                  " of the rig) is of type " + connection->second->datatype + " (definition " +
                  connection->second->md5sum +
                  "), not sensor_msgs/LaserScan or sensor_msgs/MultiEchoLaserScan" + hint);
    }
  }
}

// First pass: stamps and heads only.
void RecordingReader::Impl::IndexMessages(const Rig& rig) {
  std::map<std::string, int> scanner_indices;  // by topic
  std::vector<std::string> topics;
  for (const Scanner& scanner : rig.scanners) {
    scanner_indices[scanner.topic] = static_cast<int>(topics.size());
    topics.push_back(scanner.topic);
  }
  try {
    rosbag::View view(bag, rosbag::TopicQuery(topics));
    for (const rosbag::MessageInstance& instance : view) instances.push_back(instance);
  } catch (const std::exception& exception) {
    throw Error(path + ": the index of the bag is damaged (" + exception.what() +
                "); `rosbag reindex` may repair it");
  }
  stamps.resize(instances.size());
  for (size_t position = 0; position < instances.size(); ++position) {
    const ScanHead head = ReadMessageHead(position);
    stamps[position].scanner_index = scanner_indices.at(instances[position].getTopic());
    stamps[position].stamp_ns = head.stamp_ns;
    stamps[position].usable = head.IsUsable();
  }
  order = OrderScanLines(rig, stamps);
  orders.assign(stamps.size(), -1);
  for (size_t i = 0; i < order.positions.size(); ++i) {
    orders[order.positions[i]] = static_cast<int64_t>(i);
  }
}

// Reads what comes in the bag up to and including position. Bag order is almost the order of
// stamps, and to go through the bag in its own order spares rosbag from unpacking chunks
// twice.
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

RecordingReader::RecordingReader(const std::string& path, const Rig& rig)
    : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  impl_->directions.resize(rig.scanners.size());
  OpenBag(path, &impl_->bag);
  impl_->CheckTopics(rig);
  impl_->IndexMessages(rig);
  if (impl_->order.positions.empty()) {
    std::string reasons;
    for (const std::string& warning : impl_->order.warnings) reasons += "; " + warning;
    throw Error(path + ": has no scan lines of the rig's scanners" + reasons);
  }
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

int RecordingReader::num_scan_lines() const {
  return static_cast<int>(impl_->order.positions.size());
}

double RecordingReader::scan_period_s() const { return impl_->order.scan_period_s; }

const std::vector<std::string>& RecordingReader::warnings() const {
  return impl_->order.warnings;
}

struct RecordingWriter::Impl {
  Impl(const std::string& path, const Rig& rig)
      : rig(rig), file(path), sequence(rig.scanners.size(), 0) {}

  Rig rig;
  AtomicFile file;
  std::unique_ptr<rosbag::Bag> bag;
  std::vector<uint32_t> sequence;  // by scanner: number of its next message
  sensor_msgs::LaserScan message;

  [[noreturn]] void Fail(const std::exception& exception) {
    throw Error(file.path() + ": can not be written: " + exception.what());
  }
};

RecordingWriter::RecordingWriter(const std::string& path, const Rig& rig)
    : impl_(std::make_unique<Impl>(path, rig)) {
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
  impl_->bag = std::make_unique<rosbag::Bag>();
  try {
    impl_->bag->open(impl_->file.temporary_path(), rosbag::bagmode::Write);
    impl_->bag->setCompression(rosbag::compression::Uncompressed);
  } catch (const std::exception& exception) {
    impl_->Fail(exception);
  }
}

RecordingWriter::~RecordingWriter() {
  if (impl_->bag == nullptr) return;
  try {
    impl_->bag->close();
  } catch (const std::exception&) {
    Abandon(std::move(impl_->bag));
  }
}

void RecordingWriter::Write(const ScanLine& scan_line) {
  CHECK(impl_->bag != nullptr) << "Write() after Close()";
  CHECK_GT(scan_line.stamp_ns, 0) << "ROS stamps begin after 0";
  const size_t scanner_index = static_cast<size_t>(scan_line.scanner_index);
  CHECK_LT(scanner_index, impl_->rig.scanners.size());
  const Scanner& scanner = impl_->rig.scanners[scanner_index];

  sensor_msgs::LaserScan& message = impl_->message;
  ros::Time stamp;
  stamp.fromNSec(static_cast<uint64_t>(scan_line.stamp_ns));
  message.header.seq = impl_->sequence[scanner_index]++;
  message.header.stamp = stamp;
  message.header.frame_id = scanner.name;
  message.angle_min = static_cast<float>(scan_line.angle_min);
  message.angle_max = static_cast<float>(scan_line.BeamAngle(scan_line.num_beams() - 1));
  message.angle_increment = static_cast<float>(scan_line.angle_increment);
  message.time_increment = static_cast<float>(scan_line.time_increment_s);
  message.scan_time = static_cast<float>(1.0 / scanner.scan_rate_hz);
  message.range_min = static_cast<float>(scanner.min_range_m);
  message.range_max = static_cast<float>(scanner.max_range_m);
  message.ranges.assign(scan_line.ranges.begin(), scan_line.ranges.end());
  try {
    impl_->bag->write(scanner.topic, stamp, message);
  } catch (const std::exception& exception) {
    impl_->Fail(exception);
  }
}

void RecordingWriter::Close() {
  CHECK(impl_->bag != nullptr) << "Close() twice";
  try {
    impl_->bag->close();
  } catch (const std::exception& exception) {
    impl_->Fail(exception);
  }
  impl_->bag.reset();
  impl_->file.Commit();
}

}  // namespace plumbline
