#include "core/check/scan_messages.h"

#include <map>

#include "core/bag/bag_reader.h"
#include "core/sensor/laser_scan_message.h"

namespace plumbline {

RecordedTopics ReadScans(const std::string& path,
                         const ScanVisitor& visit) {
  BagReader bag(path);
  RecordedTopics recorded;
  std::map<std::string, int> indices;  // by topic
  const auto index_of = [&](const BagConnection& connection, bool has_scan_lines) {
    const auto [known, is_new] =
        indices.emplace(connection.topic, static_cast<int>(recorded.topics.size()));
    if (is_new) {
      recorded.topics.push_back({connection.topic, connection.type, has_scan_lines, 0});
    }
    return known->second;
  };
  ScanMessage message;
  bag.Scan(IsLaserScan, [&](const BagMessage& where, ByteView data) {
    const BagConnection& connection = bag.connections()[where.connection_index];
    message.line.scanner_index = index_of(connection, true);
    LaserScanMessage scan;
    if (!ReadLaserScan(data, IsMultiEchoLaserScan(connection), &scan, &message.line.ranges)) {
      ++recorded.topics[static_cast<size_t>(message.line.scanner_index)].num_undecodable;
      return false;
    }
    message.receipt_ns = static_cast<int64_t>(where.receipt_ns);
    message.usable = scan.IsUsable();
    message.line.stamp_ns = scan.stamp_ns;
    message.line.angle_min = scan.angle_min;
    message.line.angle_increment = scan.angle_increment;
    message.line.time_increment_s = scan.time_increment;
    visit(recorded.topics[static_cast<size_t>(message.line.scanner_index)], message);
    return true;
  });
  for (const BagConnection& connection : bag.connections()) {
    index_of(connection, IsLaserScan(connection));
  }
  recorded.warnings = bag.warnings();
  return recorded;
}

}  // namespace plumbline
