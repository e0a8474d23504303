#pragma once

#include <string>
#include <vector>

#include "core/result/result_types.h"

namespace plumbline {

// A sum over the places or beams of one second that could have contradicted the map, and how
// many of them did.
struct Share {
  double contradicted = 0.0;
  double comparable = 0.0;

  double value() const { return comparable > 0.0 ? contradicted / comparable : 0.0; }
};

// Shares by second of the recording.
using SharesOverTime = std::vector<Share>;

// Sums the shares of a second and its two neighbours: what one second sees is little.
Share Smoothed(const SharesOverTime& shares, int second);

// Makes an interval of each run of marked seconds. Runs less than `max_gap_s` apart are one.
// Each interval has this reason.
std::vector<DoubtfulInterval> IntervalsOf(const std::vector<bool>& is_marked,
                                          int max_gap_s,
                                          const std::string& reason);

}  // namespace plumbline
