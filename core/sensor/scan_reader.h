#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/sensor/recording.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/util/time.h"

namespace plumbline {

// A scan holds the scan lines that the scanners take at about the same time.
struct Scan {
  std::vector<ScanLine> scan_lines;
  std::vector<int> scan_line_indices;  // position of each in the recording
  // Instants of the first and the last beam, the scanners' time offsets included.
  int64_t start_ns = 0;
  int64_t end_ns = 0;
};

// Groups a recording's scan lines into scans: a scan ends where a scanner would occur twice or
// one scan period is over.
class ScanReader {
 public:
  ScanReader(const Rig& rig, RecordingReader* recording);

  bool Next(Scan* scan);

 private:
  bool Fetch();

  const Rig& rig_;
  RecordingReader* recording_;
  ScanLine pending_;
  int pending_index_ = -1;
  bool has_pending_ = false;
};

}  // namespace plumbline
