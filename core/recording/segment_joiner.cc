#include "core/recording/segment_joiner.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace plumbline {
namespace {

constexpr double kTurn = 2.0 * M_PI;

double SecondsFrom(int64_t begin_ns, int64_t end_ns) {
  return 1e-9 * static_cast<double>(end_ns - begin_ns);
}

}  // namespace

bool AppendSegment(const ScanLineMessage& segment, ScanLineMessage* line) {
  if (!line->angles.empty() || !segment.angles.empty()) return false;
  if (!line->IsUsable() || !segment.IsUsable() || line->frame_id != segment.frame_id) {
    return false;
  }
  const double increment = line->angle_increment;
  const double num_beams = line->num_beams;
  if (std::abs(segment.angle_increment - increment) * (num_beams + segment.num_beams) >
      0.5 * std::abs(increment)) {
    return false;
  }
  // Beams from the line's first to the segment's first.
  const double offset =
      std::round((static_cast<double>(segment.angle_min) - line->angle_min) / increment);
  if (offset < num_beams - 1.0 || offset > num_beams + segment.num_beams) return false;
  if ((offset + segment.num_beams - 1.0) * std::abs(increment) > kTurn) return false;
  const double later_s = SecondsFrom(line->stamp_ns, segment.stamp_ns);
  const double time_increment_s = line->time_increment;
  if (time_increment_s == 0.0) {
    if (later_s < 0.0 || later_s > kMaxScanSeconds) return false;
    line->time_increment = static_cast<float>(later_s / offset);
  } else if (std::abs(later_s - offset * time_increment_s) >
             0.5 * segment.num_beams * std::abs(time_increment_s)) {
    return false;
  }
  const auto begin = static_cast<uint32_t>(offset);
  if (line->ranges.size() == line->num_beams && segment.ranges.size() == segment.num_beams) {
    const bool is_shared = begin < line->num_beams;
    line->ranges.resize(std::max(begin, line->num_beams),
                        std::numeric_limits<float>::quiet_NaN());
    line->ranges.insert(line->ranges.end(),
                        segment.ranges.begin() + (is_shared ? 1 : 0),
                        segment.ranges.end());
  }
  line->num_beams = begin + segment.num_beams;
  return true;
}

void SegmentJoiner::Add(const MessageRef& message, const ScanLineMessage& scan_line) {
  Topic& topic = topics_[message.topic_index];
  if (!topic.has_segments) {
    topic.has_segments = AppendSegment(scan_line, &topic.line);
    if (!topic.has_segments) {
      topic.line = scan_line;
      topic.line.ranges.clear();
      take_({message}, scan_line);
      return;
    }
  } else if (!topic.parts.empty() && AppendSegment(scan_line, &topic.line)) {
    topic.parts.push_back(message);
    return;
  }
  TakeKept(&topic);
  topic.parts = {message};
  topic.line = scan_line;
}

void SegmentJoiner::TakeKept(Topic* topic) {
  if (topic->parts.empty()) return;
  take_(topic->parts, topic->line);
  topic->parts.clear();
}

void SegmentJoiner::Finish() {
  for (auto& [index, topic] : topics_) TakeKept(&topic);
}

}  // namespace plumbline
