#pragma once

#include <string>
#include <vector>

#include "core/result/result_types.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Reads a calibration.json. Throws Error naming the file where it is none.
Calibration ReadCalibration(const std::string& path);

// Joins the calibrations of several recordings with one rig file: the sum of their
// information, the prior of the rig file counted once. Throws Error where they are not about
// the same parameters with the same priors; names: what to call them in it.
Calibration JoinCalibrations(const std::vector<Calibration>& calibrations,
                             const std::vector<std::string>& names);

// The rig file's rig with this calibration of its scanners. Throws Error where the calibration
// is about scanners that the rig does not have.
Rig WithCalibration(const Rig& rig, const Calibration& calibration);

}  // namespace plumbline
