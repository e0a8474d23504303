#pragma once

#include <vector>

#include "core/judging/degeneracy.h"
#include "core/map/map_state.h"
#include "core/result/result_types.h"

namespace plumbline {

// WheelSlip is a stretch in which surfaces leave a direction of the position open, and along
// which the map goes farther or less far than the wheels count, beyond their noise. Before and
// after it surfaces show the position: how far the wheels are off is known, but not where.
struct WheelSlip {
  double start_s = 0.0;  // as in DegenerateInterval
  double end_s = 0.0;
  double sum_m = 0.0;  // wheels minus map, along the direction, unsigned
};

// Finds the open stretches in which the wheels' residuals along the open direction, summed,
// exceed kSignificantStddevs standard deviations of their sum: of the calibrated noise and
// scale, and of the position before and after. The spline spreads such a sum evenly, so that
// no single residual shows it. strengths: by second from start_ns, as the intervals' times.
std::vector<WheelSlip> FindWheelSlips(const MapState& state,
                                      const std::vector<PositionStrength>& strengths,
                                      const std::vector<DegenerateInterval>& open,
                                      int64_t start_ns);

}  // namespace plumbline
