#pragma once

#include <vector>

#include "core/map/map_state.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Finds landmarks that beams of other landmarks' segments pass through, so that there can be
// no surface: chords between unrelated surfaces, things that have moved. A cell of a
// landmark's patch counts as passed through when many more beams cross it, well away from the
// plane on both sides, than there are segments on it; a landmark, when this is so for more
// than half of its cells away from its rim. Only the beams at the ends and the middle of each
// segment are followed. Returns one element per landmark.
std::vector<bool> FindPassedThrough(const Rig& rig, const MapState& state);

}  // namespace plumbline
