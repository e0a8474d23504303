#pragma once

#include "core/geometry/rigid3.h"
#include "core/map/map_state.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Takes the map to another world frame, which is turned about the vertical. Constraints by
// points go: the batch takes surfaces alone. rig: its scanners as they are estimated.
void MoveMap(const Rig& rig, const Rigid3d& to_from, MapState* state);

// Turns the map so that x is the normal of the wall with most observations, which becomes the
// first landmark and holds the heading. Where there is no wall, the map stays as it is.
void TurnToWall(const Rig& rig, MapState* state);

}  // namespace plumbline
