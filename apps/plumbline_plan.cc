// Draws the floor plan of a finished map.

#include <gflags/gflags.h>

#include <cstdio>
#include <string>

#include "apps/app.h"
#include "core/outputs/floor_plan_files.h"

DEFINE_string(result,
              "",
              "directory that plumbline_map wrote; may also stand alone, without the flag");
DEFINE_string(rig, "", "rig file (YAML); without it, the one that the result holds");
DEFINE_string(output, "", "directory for the plan; without it, that of the result");

int main(int argc, char** argv) {
  return plumbline::RunApp(
      argc,
      argv,
      "draws the floor plan of a map, one for each storey (SVG, DXF), and its rooms as "
      "CityJSON, with areas and their standard deviations (rooms.json)",
      __FILE__,
      {"result"},
      [] {
        const std::string output = FLAGS_output.empty() ? FLAGS_result : FLAGS_output;
        const plumbline::FloorPlans plan =
            plumbline::RunPlanJob(FLAGS_result, FLAGS_rig, output);
        std::fputs(plumbline::RoomTable(plan).c_str(), stdout);
      },
      "result");
}
