#pragma once

#include <cstdint>
#include <vector>

#include "core/map/map_state.h"
#include "core/sensor/rig.h"

namespace plumbline {

// A floor or ceiling whose segments lie off its plane by place: here above, there below it.
struct BentSurface {
  int landmark_id = -1;
  int num_tiles = 0;       // places on it, 1.5 m wide, that many segments show
  int num_off = 0;         // those where they lie off on the whole
  double largest_m = 0.0;  // of their distances from the plane
};

struct BentSurfaces {
  std::vector<BentSurface> surfaces;  // all that were judged
  std::vector<bool> seconds;          // of the recording, in which bent places were seen
};

// Finds floors and ceilings that bend. A ramp of a degree or so may be taken for level, the
// rig being turned by as much while it is there: walls along the way do not tell. But where
// the ramp begins, both parts are seen at the same time, and lie off the plane that both are
// taken for. A turned rig sees floor and ceiling bend; what bends alone has taken segments of
// something that lies close to it, as the lowest board of a rack.
BentSurfaces FindBentSurfaces(const Rig& rig, const MapState& state, int64_t start_ns);

}  // namespace plumbline
