// Simulates an experiment: a recording of scan lines, and the truth to judge maps by.

#include <gflags/gflags.h>

#include <iostream>

#include "apps/app.h"
#include "apps/progress.h"
#include "simulation/sensing/simulate_recording.h"

DEFINE_string(experiment, "", "experiment file (YAML), such as configs/experiments/room.yaml");
DEFINE_uint64(seed, 1, "seed of the random numbers; the same seed gives the same recording");
DEFINE_string(output, "", "directory for recording.bag, rig.yaml and the truth");

namespace {

plumbline::SimulationSummary Simulate() {
  plumbline::Progress progress("simulate");
  return plumbline::SimulateRecording(
      FLAGS_experiment, FLAGS_seed, FLAGS_output, [&](const auto& state) {
        progress.Report(state);
      });
}

}  // namespace

int main(int argc, char** argv) {
  return plumbline::RunApp(
      argc,
      argv,
      "simulates a rig in a building: a recording, with the true trajectory and planes",
      __FILE__,
      {"experiment", "output"},
      [] { std::cout << plumbline::SimulationTable(Simulate(), FLAGS_output); });
}
