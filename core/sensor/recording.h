#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"

namespace plumbline {

// Reads the scan lines of a rig's scanners from a ROS 1 bag (sensor_msgs/LaserScan, or the
// first echo of MultiEchoLaserScan), in the order of their header stamps; scan lines of the
// same stamp come in the order of the rig's scanners.
class RecordingReader {
 public:
  // Throws Error when the file is missing or unreadable, lacks a topic that the rig names, or
  // has no scan line at all.
  RecordingReader(const std::string& path, const Rig& rig);
  ~RecordingReader();

  // Moves on to the next scan line; false at the end. Throws Error naming the message at fault
  // when the recording breaks off or a message can not be decoded.
  bool Next(ScanLine* scan_line);

  // Starts again from the first scan line.
  void Rewind();

  int64_t start_ns() const;    // stamp of the first scan line
  int64_t end_ns() const;      // stamp of the last scan line
  int num_scan_lines() const;  // that Next() will deliver in all
  // Median time between scan lines of the same scanner; 0 if no scanner has two of them.
  double scan_period_s() const;
  // Sentences about scan lines that were passed over or look wrong, for the user and
  // summary.json.
  const std::vector<std::string>& warnings() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Writes scan lines as a ROS 1 bag that ROS tools and RecordingReader open. The file appears
// under its name when Close() has written it whole.
class RecordingWriter {
 public:
  RecordingWriter(const std::string& path, const Rig& rig);
  ~RecordingWriter();  // without Close(): the unfinished file is removed

  void Write(const ScanLine& scan_line);
  void Close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline
