#pragma once

#include <string>
#include <vector>

#include "core/outputs/floor_plan.h"

namespace plumbline {

// A file of a floor plan: its name (docs/outputs.md) and what it holds.
struct PlanFile {
  std::string name;
  std::string content;
};

// rooms.json, building.city.json, and of each storey, from the lowest up, floor_plan.svg and
// .dxf, then floor_plan_2.svg and so on.
std::vector<PlanFile> FloorPlanFiles(const FloorPlans& plan);

// The job of plumbline_plan: plans a result directory and writes the files into the output
// directory, which is created where it does not exist. Files of storeys that an earlier plan
// had and this one has not are removed. Throws Error.
FloorPlans RunPlanJob(const std::string& result_directory,
                      const std::string& rig_file,
                      const std::string& output_directory);

// A table of the rooms, for people.
std::string RoomTable(const FloorPlans& plan);

}  // namespace plumbline
