#pragma once

#include <cstddef>
#include <vector>

#include "core/sensor/scan_line.h"

namespace plumbline {

// A topic that repeats what another holds, such as a filtered copy of it.
struct Doubling {
  size_t original = 0;  // positions of the topics
  size_t copy = 0;
  double share = 0.0;  // of the beams with a return in both, that have the very same range
};

// Compares the scan lines of topics, ordered by their stamps: two scanners never measure the
// very same ranges, copies do even where some of them have been filtered.
std::vector<Doubling> FindDoublings(const std::vector<std::vector<ScanLine>>& lines);

}  // namespace plumbline
