#pragma once

#include <string>

#include "core/outputs/floor_plan.h"

namespace plumbline {

// Makes the drawing of a storey as SVG, true to scale when printed: walls, doors with their
// widths, windows, rooms with number and area, clear dimensions, a scale bar. Sizes on paper
// in mm. The same plan gives the same bytes.
std::string FormatSvg(const FloorPlans& plan, size_t storey);

}  // namespace plumbline
