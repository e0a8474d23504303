// Simulates an experiment and prints what plumbline_simulate prints. Arguments: the experiment and the
// output directory.

#include <cstdio>

#include "simulation/sensing/simulate_recording.h"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const plumbline::SimulationSummary summary =
      plumbline::SimulateRecording(argv[1], 1, argv[2], [](double) {});
  std::fputs(plumbline::SimulationTable(summary, argv[2]).c_str(), stdout);
  return 0;
}
