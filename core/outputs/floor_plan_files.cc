#include "core/outputs/floor_plan_files.h"

#include <cstdio>
#include <filesystem>
#include <system_error>

#include "core/outputs/plan_city_json.h"
#include "core/outputs/plan_dxf.h"
#include "core/outputs/plan_json.h"
#include "core/outputs/plan_svg.h"
#include "core/util/atomic_file.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

// Name of the drawing of a storey, from 0: "floor_plan.svg", "floor_plan_2.svg", ...
std::string StoreyFileName(size_t storey, const std::string& extension) {
  return "floor_plan" + (storey == 0 ? std::string() : "_" + std::to_string(storey + 1)) +
         "." + extension;
}

// Errors name the directory, too, where they are of the map as a whole.
FloorPlans PlanOf(const std::string& result_directory, const std::string& rig_file) {
  const FloorPlanInput input = ReadFloorPlanInput(result_directory, rig_file);
  try {
    return MakeFloorPlan(input);
  } catch (const Error& error) {
    throw Error(result_directory + ": " + error.what());
  }
}

void CreateDirectories(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw Error(path + ": can not be created: " + error.message());
}

}  // namespace

std::vector<PlanFile> FloorPlanFiles(const FloorPlans& plan) {
  std::vector<PlanFile> files = {{"rooms.json", FormatRooms(plan)},
                                 {"building.city.json", FormatCityJson(plan)}};
  for (size_t i = 0; i < plan.storeys.size(); ++i) {
    files.push_back({StoreyFileName(i, "svg"), FormatSvg(plan, i)});
    files.push_back({StoreyFileName(i, "dxf"), FormatDxf(plan.storeys[i], plan.origin)});
  }
  return files;
}

FloorPlans RunPlanJob(const std::string& result_directory,
                      const std::string& rig_file,
                      const std::string& output_directory) {
  const FloorPlans plan = PlanOf(result_directory, rig_file);
  CreateDirectories(output_directory);
  for (const PlanFile& file : FloorPlanFiles(plan)) {
    WriteFileAtomically(output_directory + "/" + file.name, file.content);
  }
  for (size_t i = plan.storeys.size();; ++i) {
    bool removed = false;
    for (const char* extension : {"svg", "dxf"}) {
      std::error_code error;
      removed = std::filesystem::remove(output_directory + "/" + StoreyFileName(i, extension),
                                        error) ||
                removed;
    }
    if (!removed) return plan;
  }
}

std::string RoomTable(const FloorPlans& plan) {
  std::string table = "  storey room      area     +-        height    clear dimensions\n";
  char line[256];
  for (size_t i = 0; i < plan.storeys.size(); ++i) {
    for (const Room& room : plan.storeys[i].rooms) {
      std::snprintf(line,
                    sizeof(line),
                    "  %6zu %4d %9.2f %7.3f m2",
                    i + 1,
                    room.number,
                    room.area_m2,
                    room.area_stddev_m2);
      table += line;
      if (room.floor_m && room.ceiling_m) {
        std::snprintf(line, sizeof(line), " %6.3f m  ", *room.ceiling_m - *room.floor_m);
        table += line;
      } else {
        table += "        -  ";
      }
      for (const Dimension& dimension : room.dimensions) {
        std::snprintf(line,
                      sizeof(line),
                      " %.3f m +- %.1f mm",
                      dimension.length_m,
                      1e3 * dimension.stddev_m);
        table += line;
      }
      if (!room.entered) table += " (only looked into)";
      table += "\n";
    }
  }
  return table;
}

}  // namespace plumbline
