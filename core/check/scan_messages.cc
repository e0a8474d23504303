#include "core/check/scan_messages.h"

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include "core/recording/recording_source.h"
#include "core/sensor/scan_header.h"

namespace plumbline {
namespace {

// Takes over all of a message but its topic.
void Convert(const MessageRef& where, const ScanLineMessage& scan, ScanMessage* message) {
  message->receipt_ns = static_cast<int64_t>(where.receipt_ns);
  message->frame_id = scan.frame_id;
  message->is_planar = scan.is_planar;
  message->usable = scan.is_planar && scan.IsUsable();
  message->stated_min_range_m = scan.range_min;
  message->stated_max_range_m = scan.range_max;
  ScanLine& line = message->line;
  line.stamp_ns = scan.stamp_ns;
  line.angle_min = scan.angle_min;
  line.angle_increment = scan.angle_increment;
  line.time_increment_s = scan.time_increment;
  line.ranges = scan.ranges;
  message->is_at_stated_limit.clear();
  for (size_t beam = 0; beam < scan.ranges.size(); ++beam) {
    if (!IsStatedLimit(scan, scan.ranges[beam])) continue;
    message->is_at_stated_limit.resize(scan.ranges.size(), false);
    message->is_at_stated_limit[beam] = true;
  }
  line.angles = nullptr;
  if (!scan.angles.empty()) {
    line.angles =
        std::make_shared<std::vector<double>>(scan.angles.begin(), scan.angles.end());
  }
}

}  // namespace

RecordedTopics ReadScans(const std::string& path, const Rig* rig, const ScanVisitor& visit) {
  const std::unique_ptr<RecordingSource> source = OpenRecording(path);
  RecordedTopics recorded;
  std::map<std::string, size_t> indices;  // by name; several publishers may share a topic
  const auto index_of = [&](const RecordingTopic& topic) {
    const auto [known, is_new] = indices.emplace(topic.name, recorded.topics.size());
    if (is_new) {
      recorded.topics.push_back({topic.name, topic.type, topic.HasScanLines(), 0});
    }
    return known->second;
  };
  ScanMessage message;
  RecordingVisitor visitor;
  visitor.wants = [](const RecordingTopic& topic) { return topic.HasScanLines(); };
  const auto scanner_of = [&](const std::string& topic) -> const Scanner* {
    if (rig == nullptr) return nullptr;
    const auto found = std::find_if(rig->scanners.begin(),
                                    rig->scanners.end(),
                                    [&](const Scanner& one) { return one.topic == topic; });
    return found == rig->scanners.end() ? nullptr : &*found;
  };
  ScanLineMessage scan;
  visitor.scan_line = [&](const MessageRef& where, const ScanLineMessage& as_sent) {
    const size_t index = index_of(source->topics()[where.topic_index]);
    scan = as_sent;
    CorrectHeader(scanner_of(recorded.topics[index].name), &scan);
    Convert(where, scan, &message);
    message.line.scanner_index = static_cast<int>(index);
    visit(recorded.topics[index], message);
  };
  visitor.undecodable = [&](const MessageRef& where) {
    ++recorded.topics[index_of(source->topics()[where.topic_index])].num_undecodable;
  };
  source->Visit(visitor);
  for (const RecordingTopic& topic : source->topics()) index_of(topic);
  recorded.format = source->format();
  recorded.warnings = source->warnings();
  return recorded;
}

}  // namespace plumbline
