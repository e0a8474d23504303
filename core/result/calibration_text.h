#pragma once

#include <string>
#include <vector>

#include "core/result/result_types.h"

namespace plumbline {

// Returns, by scanner and parameter, whether the recording says more of a parameter than the
// rig file does, or it is held. That is asked of directions, since what only the rig file says
// may be the sum of several parameters: in units of the prior's standard deviations,
// directions with more than half of the prior's variance left are open. A parameter is not
// observed where it has at least half of the share in them that it would have in one that all
// scanners share alike.
std::vector<std::vector<bool>> ObservedParameters(const Calibration& calibration);

// Returns what the recording does not show of the scanners, in words: "height of scanner
// left".
std::vector<std::string> UnobservedInWords(const Calibration& calibration);

// Returns one line for a terminal: how far each scanner is from what the rig file states, and
// what is not shown.
std::string CalibrationLine(const Calibration& calibration);

// Makes calibration.json (docs/outputs.md).
std::string FormatCalibration(const Calibration& calibration);

}  // namespace plumbline
