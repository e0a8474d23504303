#pragma once

#include <set>
#include <utility>
#include <vector>

#include "core/map/map_state.h"
#include "core/options/mapper_options.h"
#include "core/sensor/rig.h"
#include "core/visibility/occupancy_grids.h"

namespace plumbline {

// Splits surfaces that hold two levels, such as a wall and the doors of a cupboard 3 cm before
// it: segments that lie on a level's cells for the most part go to a landmark of its own,
// which is the surface still, and sub-minimum segments with them; its own segments move it
// with the next estimate, and when openings are used, segments across both levels lose the
// beams on the other. Steps within the unevenness that one surface may have stay. openings: by
// landmark; gets those of the new ones. The heading stays held where its wall loses all
// segments. Returns the surface and the new landmark of each level that got a segment.
std::set<std::pair<int, int>> SplitLevels(const Rig& rig,
                                          const AssociationOptions& options,
                                          const std::vector<LevelOnSurface>& levels,
                                          std::vector<PlaneOpenings>* openings,
                                          MapState* state);

}  // namespace plumbline
