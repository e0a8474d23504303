#pragma once

#include "core/consistency/evidence.h"
#include "core/consistency/sightings.h"

namespace plumbline {

// Where beams of one time pass through what was a surface at other times: by second, how many
// of its cells other seconds have seen, and how many of these they saw differently. A cell
// that others saw both ways counts by the share of those that disagree.
struct ContradictedPassages {
  SharesOverTime shares;
  // The same without the surface of each second that is contradicted most: wrong poses
  // contradict several at once, a door that moved or an outline drawn too large one.
  SharesOverTime without_worst;
};

ContradictedPassages FindContradictedPassages(const Sightings& sightings);

}  // namespace plumbline
