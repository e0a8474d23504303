#pragma once

#include <optional>
#include <vector>

#include "core/result/result_types.h"

namespace plumbline {

// The kind of a cause. Earlier kinds bring forth evidence of the later ones, never the other
// way round, so that they are believed first.
enum class CauseOrder {
  kScanner,  // a scanner that is not as the rig file says
  kMotion,   // the pose was lost or hardly known somewhere
  kMap,      // the map contradicts itself, for no reason that is known
};

// CauseCandidate is something that may have gone wrong.
struct CauseCandidate {
  CauseOrder order = CauseOrder::kMap;
  double start_s = 0.0;  // since the recording's start, when it shows first
  Cause cause;
};

// The likeliest cause: of those earliest in order the one that shows first, since a map that
// has slipped contradicts itself ever after. None of no candidates.
std::optional<Cause> LikeliestCause(const std::vector<CauseCandidate>& candidates);

}  // namespace plumbline
