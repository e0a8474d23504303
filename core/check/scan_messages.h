#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

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
  // Limits as the driver states them, m; 0 where it states none.
  double stated_min_range_m = 0.0;
  double stated_max_range_m = 0.0;
  // By beam; empty where no range is at the limit that the driver states.
  std::vector<bool> is_at_stated_limit;
  ScanLine line;  // scanner_index: position of the topic in RecordedTopics
};

// What a recording holds besides its scan lines.
struct RecordedTopics {
  std::string format;                 // of the file, such as "ROS 1 bag"
  std::vector<RecordedTopic> topics;  // those with scan lines come first
  std::vector<std::string> warnings;  // what is damaged or missing
};

// Takes a scan line and its topic, both valid during the call only. A topic's first scan line
// has the next free index.
using ScanVisitor = std::function<void(const RecordedTopic&, const ScanMessage&)>;

// Reads all scan lines of a recording in the order of the file, whether the rig file names
// their topics or not; of those that it names, with the headers that it states
// (scan_header.h). rig: nullptr where there is none. Throws Error where the file is missing or
// no recording.
RecordedTopics ReadScans(const std::string& path, const Rig* rig, const ScanVisitor& visit);

}  // namespace plumbline
