#pragma once

#include <string>

#include "core/outputs/floor_plan.h"

namespace plumbline {

// Makes rooms.json (docs/outputs.md): the rooms of all storeys, with areas, heights, clear
// dimensions, doors and walls, and their standard deviations. The same plan gives the same
// bytes.
std::string FormatRooms(const FloorPlans& plan);

}  // namespace plumbline
