#pragma once

#include <cstdint>
#include <vector>

#include "core/map/map_state.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Seconds in which no wide surface shows the heading of a rig that moves in space, as in a
// round room, and that part its way into pieces that hardly see a wall in common: those are
// joined by the motion and by what is narrow alone, which a wrong heading takes for something
// else. start_ns: of the recording.
std::vector<bool> FindOpenJoints(const Rig& rig, const MapState& state, int64_t start_ns);

}  // namespace plumbline
