#pragma once

#include <string>
#include <vector>

#include "core/result/result_types.h"

namespace plumbline {

// The closing table of a finished map, for a terminal: figures with their units and stated
// standard deviations, the verdict, its likeliest cause and the symptoms by interval, and what
// was written where. The last line says so where the map is doubtful from end to end.
// has_report: whether there is a report.html. Ends with a line break.
std::string ClosingTable(const Summary& summary,
                         const std::vector<PlanePatch>& planes,
                         const std::vector<StampedPose>& trajectory,
                         const std::string& directory,
                         bool has_report = false);

}  // namespace plumbline
