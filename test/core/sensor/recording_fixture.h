#pragma once

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/LaserScan.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/sensor/recording.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {

inline constexpr int64_t kStart = 1'600'000'000'000'000'000;
inline constexpr int64_t kMillisecond = 1'000'000;
inline constexpr int64_t kPeriod = 25 * kMillisecond;

inline Rig MakeRig(const std::vector<std::string>& names) {
  Rig rig;
  for (const std::string& name : names) {
    Scanner scanner;
    scanner.name = name;
    scanner.topic = "/" + name + "_scan";
    rig.scanners.push_back(scanner);
  }
  return rig;
}

inline ScanLine MakeScanLine(int scanner_index, int64_t stamp_ns) {
  ScanLine scan_line;
  scan_line.scanner_index = scanner_index;
  scan_line.stamp_ns = stamp_ns;
  scan_line.angle_min = -0.5f;
  scan_line.angle_increment = 0.25f;
  scan_line.time_increment_s = 0.0009765625;
  scan_line.ranges = {1.0f, 2.0f, 3.0f + static_cast<float>(scanner_index), 4.0f, 5.0f};
  return scan_line;
}

inline sensor_msgs::LaserScan MakeMessage(int64_t stamp_ns) {
  sensor_msgs::LaserScan message;
  message.header.stamp.fromNSec(static_cast<uint64_t>(stamp_ns));
  message.angle_min = -0.5f;
  message.angle_increment = 0.25f;
  message.time_increment = 0.001f;
  message.ranges = {1.0f, 2.0f, 3.0f};
  return message;
}

// Writes bags with ROS' own library and reads them.
class RecordingTest : public TemporaryDirectoryTest {
 protected:
  void SetUp() override {
    TemporaryDirectoryTest::SetUp();
    path_ = (directory_ / "recording.bag").string();
  }

  // Receipt times are a millisecond apart, whatever the stamp in the message.
  template <typename Message>
  void Record(rosbag::Bag* bag, const std::string& topic, const Message& message) {
    receipt_ns_ += kMillisecond;
    ros::Time receipt;
    receipt.fromNSec(static_cast<uint64_t>(receipt_ns_));
    bag->write(topic, receipt, message);
  }

  // Scan lines of one scanner with these stamps in milliseconds.
  void RecordStamps(const std::vector<int>& stamps_ms) {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    for (int stamp_ms : stamps_ms) {
      Record(&bag, "/top_scan", MakeMessage(kStart + stamp_ms * kMillisecond));
    }
  }

  std::vector<ScanLine> ReadAll(RecordingReader* reader) {
    std::vector<ScanLine> scan_lines;
    ScanLine scan_line;
    while (reader->Next(&scan_line)) scan_lines.push_back(scan_line);
    return scan_lines;
  }

  std::vector<int> DeliveredStampsMs(RecordingReader* reader) {
    std::vector<int> stamps_ms;
    for (const ScanLine& scan_line : ReadAll(reader)) {
      stamps_ms.push_back(static_cast<int>((scan_line.stamp_ns - kStart) / kMillisecond));
    }
    return stamps_ms;
  }

  std::string OpenError(const std::vector<std::string>& names) {
    return ErrorOf([&] { RecordingReader reader(path_, MakeRig(names)); });
  }

  std::string path_;
  int64_t receipt_ns_ = kStart;
};

}  // namespace plumbline
