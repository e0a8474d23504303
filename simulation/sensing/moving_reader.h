#pragma once

#include "core/util/yaml_node.h"
#include "simulation/world/moving_things.h"

namespace plumbline {

// Reads the section "moving" of an experiment: people and doors. Throws Error with file and
// line.
MovingOptions ReadMoving(const YamlNode& node, double floor_height);

}  // namespace plumbline
