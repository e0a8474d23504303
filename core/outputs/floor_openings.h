#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/outputs/floor_plan.h"

namespace plumbline {

// Finds where the rooms of a storey have no floor, such as over a stair to the storey below:
// in squares of 10 cm through which more beams passed the floor's height, from or to at least
// 0.3 m below it, than ended on the floor. Squares of which no beam tells anything are taken
// for what the nearest one is. Openings of less than 0.5 m2 are none. Takes their areas out of
// the rooms'.
void FindFloorOpenings(const std::vector<PlanePatch>& planes,
                       const std::vector<CloudPoint>& points,
                       const BeamOrigins& origins,
                       const StoreyLevel& level,
                       std::vector<Room>* rooms);

}  // namespace plumbline
