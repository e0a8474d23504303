#pragma once

#include <vector>

#include "core/judging/check.h"

namespace plumbline {

// The functions below add their findings to report->findings, from the rest of the report.

// Finds odd rates, gaps, jumps of the clock, and scan lines that take longer than they may.
void FindTimingFaults(CheckReport* report);
// Finds dead, frozen and blind scanners, other units, noise, and returns of the rig itself.
void FindRangeFaults(CheckReport* report);
// Finds wheels that say nothing, or not what the scanners see, or not when.
void FindWheelFaults(CheckReport* report);
// Finds topics of rig and recording that do not fit, and scanners that do not stand as the rig
// file says.
void FindRigFaults(CheckReport* report);

// Whether a correction is surely so large that no right map can come of the rig file as it is.
bool IsLarge(const MountingCorrection& correction);

}  // namespace plumbline
