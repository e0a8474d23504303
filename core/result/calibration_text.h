#pragma once

#include <string>
#include <vector>

#include "core/result/result_types.h"

namespace plumbline {

// Returns what the recording does not show of the scanners, in words: "height of scanner
// left".
std::vector<std::string> UnobservedInWords(const Calibration& calibration);

// Returns one line for a terminal: how far each scanner is from what the rig file states, and
// what is not shown.
std::string CalibrationLine(const Calibration& calibration);

// Makes calibration.json (docs/outputs.md).
std::string FormatCalibration(const Calibration& calibration);

}  // namespace plumbline
