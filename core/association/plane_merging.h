#pragma once

#include <utility>
#include <vector>

#include "core/map/map_state.h"
#include "core/options/mapper_options.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Finds pairs (older, newer) of landmarks that are one surface: of the same kind and facing
// the same side, seen next to each other, without a statistically significant difference in
// position and direction where they meet, that difference being known to better than the
// scanners' range noise. Only pairs with a landmark seen since scan `since_scan` are compared,
// and, with loop closure off, only within the allowed gap.
std::vector<std::pair<int, int>> FindMergeable(const Rig& rig,
                                               const MapState& state,
                                               const MapperOptions& options,
                                               int since_scan);

// Whether `weak` is redundant, a plane that only repeats `strong`: it faces the same side,
// lies for the most part where `strong` has been seen too, and differs from it by no more than
// single ranges can tell. Segments that took in beams of a neighbouring surface (an open
// door's jamb, seen along the wall) make redundant planes, and so do traces of a roof that
// look like a wall's, whichever side that faces.
bool IsRedundant(const Landmark& weak, const Landmark& strong, double range_noise_m);

// Whether two surfaces do not differ significantly, given their covariances, somewhere across
// what was seen of `weak`. Of two that meet nowhere neither repeats the other: a door leaf in
// its frame, of which beams from far away were taken for the wall's.
bool Meet(const Landmark& weak, const Landmark& strong, const AssociationOptions& options);

// Makes landmark `from` part of `into`: its observations, extent and times.
void MergeInto(int into, int from, MapState* state);

}  // namespace plumbline
