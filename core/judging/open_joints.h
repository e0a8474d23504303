#pragma once

#include <cstdint>
#include <vector>

#include "core/map/map_state.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Seconds in which no wide surface shows the rig's heading, as in a round room, and after
// which no wall is known again that was seen before: the parts before and after are joined by
// the motion and by what is narrow alone, which a wrong heading takes for something else.
std::vector<bool> FindOpenJoints(const Rig& rig, const MapState& state, int64_t start_ns);

}  // namespace plumbline
