#pragma once

#include <string>

#include "core/outputs/floor_plan.h"

namespace plumbline {

// Makes building.city.json (CityJSON 2.0): a Building with BuildingStorey and BuildingRoom
// objects. A room with floor and ceiling is a Solid with FloorSurface, CeilingSurface and
// InteriorWallSurface, others are their floor alone. The same plan gives the same bytes.
std::string FormatCityJson(const FloorPlans& plan);

}  // namespace plumbline
