#pragma once

#include <string>
#include <vector>

#include "core/result/result_types.h"

namespace plumbline {

// What a finished map is, for people at a terminal: figures with their units and stated
// standard deviations, the verdict with its reasons, and what was written where. Ends with a
// line break.
std::string ClosingTable(const Summary& summary,
                         const std::vector<PlanePatch>& planes,
                         const std::vector<StampedPose>& trajectory,
                         const std::string& directory);

}  // namespace plumbline
