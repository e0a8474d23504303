#include "core/consistency/likely_cause.h"

#include <algorithm>
#include <tuple>

namespace plumbline {

std::optional<Cause> LikeliestCause(const std::vector<CauseCandidate>& candidates) {
  const auto best = std::min_element(
      candidates.begin(),
      candidates.end(),
      [](const CauseCandidate& a, const CauseCandidate& b) {
        return std::make_tuple(a.order, a.start_s, -a.strength) <
               std::make_tuple(b.order, b.start_s, -b.strength);
      });
  if (best == candidates.end()) return std::nullopt;
  return best->cause;
}

}  // namespace plumbline
