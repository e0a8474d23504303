#pragma once

#include <vector>

#include "core/outputs/floor_plan.h"
#include "core/outputs/storey_planner.h"

namespace plumbline {

// The loops of a room of the storey, the outer one first: its cells' common boundary, every
// corner moved to where the surfaces of its two edges meet. Of the surfaces of a face, an edge
// lies on the one that was hit most along it.
std::vector<RoomLoop> TraceRoom(int room,
                                const StoreyRegions& regions,
                                const std::vector<PlanePatch>& planes,
                                double section_m);

// The area that loops enclose by straight edges, m^2; loops run clockwise count as holes.
double LoopArea(const RoomLoop& loop);
bool IsInside(const std::vector<RoomLoop>& loops, const Eigen::Vector2d& p);

}  // namespace plumbline
