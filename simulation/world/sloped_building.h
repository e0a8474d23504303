#pragma once

#include <vector>

#include "simulation/world/building.h"

namespace plumbline {

// Makes the faces of storeys whose floors and ceilings may slope or lie at several heights,
// with ramps, stairs, roofs and openings between storeys: what MakeBuilding does for one level
// storey. Throws Error naming file and line when nothing is free, when walls leave a face of
// less than a millimetre, and when stairs, a roof or a floor opening change nothing.
Building MakeSlopedBuilding(const std::vector<FloorPlan>& storeys);

}  // namespace plumbline
