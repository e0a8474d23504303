#pragma once

#include <memory>
#include <vector>

#include "core/outputs/floor_map.h"
#include "core/outputs/map_cloud.h"
#include "core/outputs/plan_scales.h"
#include "core/result/result_types.h"

namespace plumbline {

// StoreyHeights says how high a storey is at one place. Heights in the model frame, m.
struct StoreyHeights {
  double floor_m = 0.0;
  double top_m = 0.0;        // of its ceiling, or of the space below the next storey
  bool has_floor = true;     // false: no floor was seen (scanners that are all level)
  bool has_ceiling = false;  // a level ceiling was seen
  // The heights above the floor at which a wall is looked at: low enough to be below lintels,
  // high enough to be above skirtings. A planar map has points at one height only.
  double band_low_m() const { return floor_m + (has_floor ? 0.1 : -1.0); }
  double band_high_m() const { return floor_m + (has_floor ? 2.0 : 1.0); }
};

// StoreyLevel is one storey: floors that the rig went over and that meet, by steps or ramps.
// Its own heights are those of the floor over which the rig went most.
struct StoreyLevel : StoreyHeights {
  std::shared_ptr<const FloorMap> floors;  // null: one floor only

  // The heights at a place of the plan.
  StoreyHeights At(const Eigen::Vector2d& p) const;
  // The height at which the plan cuts the building.
  double section_m() const { return floor_m + (has_floor ? 1.2 : 0.0); }
};

// The storeys of a map, from the lowest up. Floors are upward surfaces, level or sloping, over
// which the rig went for at least 2 m. Floors of one storey lie less than 1.8 m above each
// other; the rig is as high above each of them, or they are no floors, but tables. Where there
// is no floor, one storey at the height of the first pose. points: where floors were seen.
std::vector<StoreyLevel> FindStoreys(const std::vector<PlanePatch>& planes,
                                     const std::vector<StampedPose>& poses,
                                     const std::vector<CloudPoint>& points);

// Distance by which a level surface may go on beyond what was seen of it, m.
inline constexpr double kOutlineMarginM = 0.5;

// True where the point lies inside the polygon in plan, or within margin_m of it.
bool CoversInPlan(const std::vector<Eigen::Vector3d>& outline,
                  const Eigen::Vector2d& p,
                  double margin_m);

}  // namespace plumbline
