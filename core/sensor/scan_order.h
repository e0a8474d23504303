#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/sensor/rig.h"

namespace plumbline {

// ScanStamp holds the parts of a message that decide whether and when its scan line is used.
struct ScanStamp {
  int64_t stamp_ns = 0;
  int scanner_index = 0;
  bool usable = true;  // false: no ranges, or angles or times that make no sense
  int64_t receipt_ns = 0;  // when the recorder received it
};

// Scan lines that were passed over for one reason.
struct PassedOver {
  int count = 0;
  int64_t first_ns = 0;

  void Add(int64_t time_ns) {
    if (count++ == 0) first_ns = time_ns;
  }
};

// Scan lines of one scanner that were passed over.
struct PassedOverLines {
  PassedOver unusable;
  PassedOver repeated;  // first_ns: stamp of the scan line used before it
  PassedOver jumped;    // as above
  PassedOver apart;     // first_ns: their own stamp
};

// ScanOrder says which messages of a recording to use, and in which order.
struct ScanOrder {
  // Indices of messages, ordered by stamp, at equal stamps by scanner. The stamps of each
  // scanner increase strictly.
  std::vector<size_t> positions;
  double scan_period_s = 0.0;  // median over all scanners; 0 if none has two scan lines
  std::vector<PassedOverLines> passed_over;  // by scanner
  std::vector<std::string> warnings;
};

// Orders the messages of a recording (given in the order of the recording) by their stamps.
// A message that comes out of turn is sorted in where its stamp fills a place that the others
// leave free. Left out, and warned of, are messages that are not usable, whose stamps repeat
// or jump back onto others, and whose stamps lie apart from all others: less than a second of
// them, where the recorder received them without that gap, or more than an hour away (a clock
// that was not yet set says 1970). Warns of gaps, too:
//   - a scanner without any scan line, one that starts late or stops early: by more than 1 s
//     and 10 of its periods;
//   - a gap in all scanners at once: more than 0.5 s and 10 periods.
// Times in warnings count from the first scan line that is used. unusable_reasons: by scanner,
// of the first message that is not usable.
ScanOrder OrderScanLines(const Rig& rig,
                         const std::vector<ScanStamp>& stamps,
                         const std::vector<std::string>& unusable_reasons = {});

}  // namespace plumbline
