#pragma once

#include "core/local_map/scan_matching.h"
#include "core/map/map_state.h"
#include "core/options/mapper_options.h"

namespace plumbline {

// How far a scan lies on planes, by its observations first .. last.

// The share of its points that are on no plane.
double ShareOnNoPlane(const MapState& state,
                      int first_observation,
                      int last_observation,
                      int num_points);

// Its beams that are on no plane, by scan line.
BeamMask BeamsOnNoPlane(const MapState& state,
                        int first_observation,
                        int last_observation,
                        const ScanMatcher& scan_matcher);

// Whether its walls, planes wider than options.planes.small_m, leave the rig's position open
// in some horizontal direction.
bool WallsLeaveOpen(const MapState& state,
                    int first_observation,
                    int last_observation,
                    const MapperOptions& options);

}  // namespace plumbline
