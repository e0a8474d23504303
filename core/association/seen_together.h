#pragma once

#include "core/map/map_state.h"
#include "core/sensor/rig.h"
#include "core/surface/landmark.h"

namespace plumbline {

// Whether two surfaces that may be one lie significantly apart by their segments of the same
// seconds. Their covariances hold what the poses may be off, too, which moves both alike: over
// an hour more than walls are apart. b is compared where it was seen, with what the direction
// of a may be off as far as there. flatness_m: standard deviation of real surfaces from their
// plane. False where they were never seen within one second.
bool LieApart(const Rig& rig,
              const MapState& state,
              const Landmark& a,
              const Landmark& b,
              double flatness_m);

}  // namespace plumbline
