#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/recording/message_file.h"
#include "core/recording/messages.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"

namespace plumbline {

// A topic of a recording.
struct RecordedTopic {
  std::string name;
  std::string type;  // of its messages, such as "sensor_msgs/LaserScan"
  bool has_scan_lines = false;
  int num_undecodable = 0;  // messages whose lengths contradict each other
};

// A scan line as it stands in the recording, of any topic.
struct ScanMessage {
  int64_t receipt_ns = 0;  // when the recorder received it, since 1970
  std::string frame_id;    // empty where the format has none
  bool is_planar = true;   // false: a point cloud that does not lie in one scan plane
  bool usable = true;      // false: no beams, or angles or times that make no sense
  std::string unusable_reason;
  // Limits as the driver states them, m; 0 where it states none.
  double stated_min_range_m = 0.0;
  double stated_max_range_m = 0.0;
  // Whether a beam's range is at the limit that the driver states, by beam; empty where none
  // is.
  std::vector<bool> is_at_stated_limit;
  ScanLine line;  // scanner_index: position of the topic among those with scan lines
};

// A message as it is used, but for its topic: with the header that the rig file states
// (scan_header.h). scanner: nullptr where the rig file does not name the topic.
void TakeOver(const MessageRef& where,
              const ScanLineMessage& as_sent,
              const Scanner* scanner,
              ScanMessage* message);

}  // namespace plumbline
