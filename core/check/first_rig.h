#pragma once

#include <string>

#include "core/check/check.h"

namespace plumbline {

// A first rig file for a recording: topics, noise and limits as the scan lines show them, the
// scanners' poses left to be filled in (docs/inputs.md). ReadRig understands it as it is.
std::string FormatFirstRig(const CheckReport& report);

}  // namespace plumbline
