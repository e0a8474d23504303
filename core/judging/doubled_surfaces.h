#pragma once

#include <vector>

#include "core/judging/evidence.h"
#include "core/judging/sightings.h"
#include "core/map/map_state.h"

namespace plumbline {

// Two planes that face the same side, one closely before the other over a common area, and
// have never been seen there at the same time: one surface that stands in the map twice. Real
// surfaces in front of others (doors, steps, furniture) are seen together with what is beside
// or behind them.
struct DoubledSurface {
  int landmark_a = -1;
  int landmark_b = -1;
  double separation_m = 0.0;
  double area_m2 = 0.0;  // that both cover
};

struct DoubledSurfaces {
  std::vector<DoubledSurface> pairs;
  // Cells that were hit in a second, and those of them that belong to a pair, by the share of
  // the time in which the other one was seen.
  SharesOverTime shares;
};

DoubledSurfaces FindDoubledSurfaces(const MapState& state, const Sightings& sightings);

}  // namespace plumbline
