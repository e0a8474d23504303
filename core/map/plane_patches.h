#pragma once

#include <vector>

#include "core/map/map_state.h"
#include "core/result/result_types.h"

namespace plumbline {

// The landmarks with observations as plane patches, ids as in the state.
std::vector<PlanePatch> PlanePatches(const MapState& state);

}  // namespace plumbline
