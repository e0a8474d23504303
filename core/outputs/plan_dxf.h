#pragma once

#include <string>

#include "core/outputs/floor_plan.h"

namespace plumbline {

// Makes the drawing of a storey as DXF R12, in metres of the model frame. Layers: WALLS
// (closed outlines of what is solid, and lines along the faces that look into rooms), ROOMS
// (closed outlines), DOORS, WINDOWS, DIMENSIONS, TEXT, WARNING. origin: of the map. The same
// plan gives the same bytes.
std::string FormatDxf(const StoreyPlan& storey, const MapOrigin& origin);

}  // namespace plumbline
