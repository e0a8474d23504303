#pragma once

#include "core/map/map_state.h"
#include "core/sensor/rig.h"

namespace plumbline {

// The walls of a map whose trajectory has been bent, visit by visit.

// Takes a wall apart that came back into view after an absence: while the rig was followed,
// drift decided which of the walls known from before it was taken for. Returns how many new
// walls there are. The observations are in the order of time.
int SplitWallsByVisits(MapState* state);

// Puts each wall where its segments lie by the trajectory.
void PlaceWalls(const Rig& rig, MapState* state);

// Makes one of walls that lie together, side by side or one in the other, and were not seen
// at the same time: what is seen together is two things, such as a wall and a door that stands
// back in it. Returns how many walls became part of another one.
int MergeVisitedWalls(MapState* state);

}  // namespace plumbline
