#pragma once

#include <vector>

#include "core/outputs/floor_plan.h"
#include "core/outputs/storey_planner.h"

namespace plumbline {

// The doors of a storey that lead into one of its rooms, and wide openings between two of
// them. The gaps of the two faces of a wall are one door. Both sides of a door may be one
// room, where there is another way round.
std::vector<PlanDoor> FindDoors(const StoreyRegions& regions,
                                const std::vector<PlanePatch>& planes,
                                const std::vector<Room>& rooms);

// The windows in the edges of rooms, at least 0.4 m wide: beams pass above a parapet, or
// through an opening that leads out of doors. Panes with posts between them are one.
std::vector<PlanWindow> FindWindows(const StoreyRegions& regions,
                                    const std::vector<PlanePatch>& planes,
                                    const std::vector<Room>& rooms);

// The outlines of what is solid: cells up to 0.6 m thick behind the walls of rooms, the
// corners between such, and what rooms enclose; never where the rig was. kept_rooms: of each
// room of the regions, whether it is one of the plan.
std::vector<std::vector<Eigen::Vector2d>> FindSolids(const std::vector<bool>& kept_rooms,
                                                     StoreyRegions regions,
                                                     const std::vector<PlanePatch>& planes,
                                                     double section_m);

}  // namespace plumbline
