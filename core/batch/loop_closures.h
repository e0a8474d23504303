#pragma once

#include <vector>

#include "core/map/map_state.h"
#include "core/options/mapper_options.h"
#include "core/result/result_types.h"
#include "core/sensor/rig.h"

namespace plumbline {

// A landmark that is seen again after an absence of more than
// options.loop_closure.max_gap_scans scans closes a loop. All segments of the visit are held
// against those of the visits before: the difference of their mean deviations from the plane,
// each mean over its own variance and that of the surface's unevenness, which is the same for
// all segments of a visit. Surfaces that are seen again within a few seconds belong to one
// return, and are tested together as well.
//
// A closure is contradicted where the difference is significant on its own and for the return
// as a whole, and larger than what a surface's unevenness and a rig's calibration leave. The
// closures are in the order of time, by landmark.
std::vector<LoopClosure> TestLoopClosures(const Rig& rig,
                                          const MapperOptions& options,
                                          const MapState& state);

// Takes back the contradicted closures: the segments from the visit on go to a new landmark.
// Adds these closures to `rejected`, with the new landmark as surface_b, and returns how many
// segments changed their landmark. The observations are in the order of time.
int TakeBackContradictedClosures(const Rig& rig,
                                 const MapperOptions& options,
                                 MapState* state,
                                 std::vector<LoopClosure>* rejected);

}  // namespace plumbline
