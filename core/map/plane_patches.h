#pragma once

#include <vector>

#include "core/map/map_state.h"
#include "core/result/result_types.h"

namespace plumbline {

// Converts the landmarks that have observations to plane patches, with the ids of the state.
std::vector<PlanePatch> PlanePatches(const MapState& state);

}  // namespace plumbline
