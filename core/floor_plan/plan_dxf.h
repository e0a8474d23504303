#pragma once

#include <string>

#include "core/floor_plan/floor_plan.h"

namespace plumbline {

// Makes the drawing of a storey as DXF R12, in metres of the model frame. Layers: WALLS
// (closed outlines of what is solid), ROOMS (closed outlines), DOORS, WINDOWS, DIMENSIONS,
// TEXT. The same plan gives the same bytes.
std::string FormatDxf(const StoreyPlan& storey);

}  // namespace plumbline
