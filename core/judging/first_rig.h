#pragma once

#include <string>

#include "core/judging/check.h"

namespace plumbline {

// A first rig file for a recording: topics, noise and limits as the scan lines show them, the
// scanners' poses as /tf_static says, or left to be filled in (docs/inputs.md). ReadRig
// understands it as it is.
std::string FormatFirstRig(const CheckReport& report);

// Whether /tf_static says where every scanner sits, so that nothing is left to be filled in.
bool HasAllPoses(const CheckReport& report);

}  // namespace plumbline
