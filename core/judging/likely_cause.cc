#include "core/judging/likely_cause.h"

#include <algorithm>
#include <tuple>

namespace plumbline {

std::optional<Cause> LikeliestCause(const std::vector<CauseCandidate>& candidates) {
  const auto best =
      std::min_element(candidates.begin(),
                       candidates.end(),
                       [](const CauseCandidate& a, const CauseCandidate& b) {
                         return std::tie(a.order, a.start_s) < std::tie(b.order, b.start_s);
                       });
  if (best == candidates.end()) return std::nullopt;
  return best->cause;
}

}  // namespace plumbline
