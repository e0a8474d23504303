#pragma once

#include <functional>
#include <string>
#include <vector>

#include "simulation/world/building.h"
#include "simulation/world/free_column.h"
#include "simulation/world/plan_triangulation.h"

namespace plumbline {

// A free space whose floors and ceilings are planes of any slope and whose walls are upright.
struct ColumnPlan {
  std::string location;  // "file:line", for messages
  // Between these lines the same planes bound what is free above all places, in one order.
  std::vector<PlanLine> lines;
  std::function<FreeColumn(const Eigen::Vector2d&)> free_at;
  std::vector<PlanCircle> circles;  // that arcs among the lines lie on
};

// Makes the faces between what is free and what is not: floors and ceilings, level or sloped,
// then upright planes, then the cylinders of arcs. An upright face lies where two columns
// meet, at the heights that are free in one of them only. Coplanar pieces that touch and face
// the same side are one face. Throws Error naming the place when walls leave a face with an
// edge of less than a millimetre.
std::vector<Face> MakeColumnFaces(const ColumnPlan& plan);

}  // namespace plumbline
