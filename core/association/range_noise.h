#pragma once

#include <vector>

#include "core/map/map_state.h"
#include "core/result/result_types.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Estimates the noise of the ranges of each scanner from the scatter of its beams about the
// lines of their segments, near the map's surfaces: in all, by distance and by angle of
// incidence. Uneven surfaces count as noise; errors of poses, clocks and mountings do not. The
// rig: with the scanners as they are estimated.
std::vector<ScannerNoise> EstimateRangeNoise(const Rig& rig, const MapState& state);

}  // namespace plumbline
