#pragma once

#include <vector>

#include "core/check/check.h"

namespace plumbline {

// These add to report->findings what they find, from the rest of the report.

// Rates, gaps, jumps of the clock, scan lines that take longer than they may.
void FindTimingFaults(CheckReport* report);
// Dead, frozen and blind scanners, units, noise, returns of the rig itself.
void FindRangeFaults(CheckReport* report);
// Wheels that say nothing, or not what the scanners see, or not when.
void FindWheelFaults(CheckReport* report);
// Topics of rig and recording that do not fit, scanners that do not stand as the rig says.
void FindRigFaults(CheckReport* report);

// Whether a correction is surely so large that no right map can come of the rig file as it is.
bool IsLarge(const MountingCorrection& correction);

}  // namespace plumbline
