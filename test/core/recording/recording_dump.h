#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/recording/recording_source.h"

namespace plumbline {

inline std::string DumpOf(const ScanLineMessage& scan) {
  char text[200];
  std::snprintf(text,
                sizeof(text),
                "scan %lld '%s' %a %a %a %a %a %u:",
                static_cast<long long>(scan.stamp_ns),
                scan.frame_id.c_str(),
                static_cast<double>(scan.angle_min),
                static_cast<double>(scan.angle_increment),
                static_cast<double>(scan.time_increment),
                static_cast<double>(scan.range_min),
                static_cast<double>(scan.range_max),
                scan.num_beams);
  std::string dump = text;
  for (const auto* numbers : {&scan.ranges, &scan.angles}) {
    for (const float number : *numbers) {
      std::snprintf(text, sizeof(text), " %a", static_cast<double>(number));
      dump += text;
    }
    dump += ";";
  }
  return dump;
}

inline std::string DumpOf(const OdometryMessage& odometry) {
  char text[300];
  std::snprintf(text,
                sizeof(text),
                "odometry %lld '%s' '%s' %a %a %a %a %a",
                static_cast<long long>(odometry.stamp_ns),
                odometry.frame_id.c_str(),
                odometry.child_frame_id.c_str(),
                odometry.position[0],
                odometry.position[1],
                odometry.Yaw(),
                odometry.linear_velocity[0],
                odometry.angular_velocity[2]);
  return text;
}

// A recording as text, message by message.
struct RecordingDump {
  std::vector<std::string> messages;  // topic, receipt, content
  std::vector<std::string> topics;    // name, number of messages
  std::vector<std::string> warnings;
  int num_undecodable = 0;
};

// Reads all of a recording. Scan lines are read again, the last one first, and must be the
// same.
inline RecordingDump Dump(const std::string& path) {
  const std::unique_ptr<RecordingSource> source = OpenRecording(path);
  RecordingDump dump;
  std::vector<std::pair<MessageRef, std::string>> scans;
  const auto add = [&](const MessageRef& message, const std::string& content) {
    dump.messages.push_back(source->topics()[message.topic_index].name + " " +
                            std::to_string(message.receipt_ns) + " " + content);
  };
  RecordingVisitor visitor;
  visitor.scan_line = [&](const MessageRef& message, const ScanLineMessage& scan) {
    add(message, DumpOf(scan));
    scans.emplace_back(message, DumpOf(scan));
  };
  visitor.odometry = [&](const MessageRef& message, const OdometryMessage& odometry) {
    add(message, DumpOf(odometry));
  };
  visitor.undecodable = [&](const MessageRef&) { ++dump.num_undecodable; };
  source->Visit(visitor);
  for (const RecordingTopic& topic : source->topics()) {
    dump.topics.push_back(topic.name + " " + std::to_string(topic.num_messages));
  }
  dump.warnings = source->warnings();
  ScanLineMessage again;
  for (auto scan = scans.rbegin(); scan != scans.rend(); ++scan) {
    source->ReadScanLine(scan->first, &again);
    EXPECT_EQ(DumpOf(again), scan->second);
  }
  return dump;
}

}  // namespace plumbline
