#pragma once

#include "core/map/map_state.h"
#include "core/registration/part_matching.h"
#include "core/sensor/rig.h"

namespace plumbline {

// The map of a part from above, at about the height of the scanners: spots on what was seen of
// its walls, and some of the beams that ended there.
PartView ViewFromAbove(const Rig& rig, const MapState& state, double spacing_m);

}  // namespace plumbline
