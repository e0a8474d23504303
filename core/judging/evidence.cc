#include "core/judging/evidence.h"

#include <algorithm>

namespace plumbline {

Share Smoothed(const SharesOverTime& shares, int second) {
  Share sum;
  const int last = std::min(second + 1, static_cast<int>(shares.size()) - 1);
  for (int at = std::max(0, second - 1); at <= last; ++at) {
    sum.contradicted += shares[static_cast<size_t>(at)].contradicted;
    sum.comparable += shares[static_cast<size_t>(at)].comparable;
  }
  return sum;
}

std::vector<DoubtfulInterval> IntervalsOf(const std::vector<bool>& is_marked,
                                          int max_gap_s,
                                          const std::string& reason) {
  std::vector<DoubtfulInterval> intervals;
  for (size_t second = 0; second < is_marked.size(); ++second) {
    if (!is_marked[second]) continue;
    const auto start_s = static_cast<double>(second);
    if (!intervals.empty() && start_s - intervals.back().end_s < max_gap_s) {
      intervals.back().end_s = start_s + 1.0;
    } else {
      intervals.push_back({start_s, start_s + 1.0, reason});
    }
  }
  return intervals;
}

}  // namespace plumbline
