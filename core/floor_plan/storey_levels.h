#pragma once

#include <vector>

#include "core/result/result_types.h"

namespace plumbline {

// StoreyLevel is one storey: a floor that the rig went over, and how high it is. Heights in
// the model frame, m.
struct StoreyLevel {
  double floor_m = 0.0;
  double top_m = 0.0;        // of its ceiling, or of the space below the next storey
  bool has_floor = true;     // false: no floor was seen (scanners that are all level)
  bool has_ceiling = false;  // a level ceiling was seen
  // The heights above the floor at which a wall is looked at: low enough to be below lintels,
  // high enough to be above skirtings. A planar map has points at one height only.
  double band_low_m() const { return floor_m + (has_floor ? 0.1 : -1.0); }
  double band_high_m() const { return floor_m + (has_floor ? 2.0 : 1.0); }
  // The height at which the plan cuts the building.
  double section_m() const { return floor_m + (has_floor ? 1.2 : 0.0); }
};

// The storeys of a map, from the lowest up: levels of upward surfaces over which the rig went
// for at least 2 m, those less than 1.8 m above another one left out (steps, landings). Where
// there is no such floor, one storey at the height of the first pose.
std::vector<StoreyLevel> FindStoreys(const std::vector<PlanePatch>& planes,
                                     const std::vector<StampedPose>& poses);

// True where the point lies inside the polygon in plan, or within margin_m of it.
bool CoversInPlan(const std::vector<Eigen::Vector3d>& outline,
                  const Eigen::Vector2d& p,
                  double margin_m);

}  // namespace plumbline
