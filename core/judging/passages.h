#pragma once

#include "core/judging/evidence.h"
#include "core/judging/sightings.h"
#include "core/map/map_state.h"

namespace plumbline {

// ContradictedPassages counts beams that pass through what was a surface at other times: by
// second, the cells that other seconds have seen, and those of them that these saw
// differently. A cell that others saw both ways counts by the share of those that disagree.
struct ContradictedPassages {
  SharesOverTime shares;
  // Shares without the wall of each second that is contradicted most: wrong poses contradict
  // several surfaces at once, a door that moved or an outline drawn too large only one. Floors
  // and ceilings do not move.
  SharesOverTime without_worst;
};

ContradictedPassages FindContradictedPassages(const MapState& state,
                                              const Sightings& sightings);

}  // namespace plumbline
