#pragma once

#include <vector>

#include "core/map/map_state.h"
#include "core/options/mapper_options.h"
#include "core/sensor/rig.h"
#include "core/surface/landmark.h"

namespace plumbline {

// Narrow walls side by side that are chords of one upright cylinder.
struct RowOfChords {
  std::vector<int> landmarks;  // ids
  Landmark cylinder;           // its extent empty, its covariance for the poses given
};

// Finds the rows of three chords or more: round columns and bays too narrow for a single
// segment to show that they bend. Each row is explained by one cylinder as well as the noise
// of its segments allows; of a polygon, whose sides do not bow, the fit is bad. The wall that
// fixes the gauge is in none.
std::vector<RowOfChords> FindRowsOfChords(const Rig& rig,
                                          const AssociationOptions& options,
                                          const MapState& state);

}  // namespace plumbline
