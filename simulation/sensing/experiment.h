#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/sensor/rig.h"
#include "simulation/sensing/faults.h"
#include "simulation/world/building.h"
#include "simulation/world/moving_things.h"
#include "simulation/world/path.h"

namespace plumbline {

// NoiseOptions change the noise that the rig file states.
struct NoiseOptions {
  double scale = 1.0;    // of the scanners' range noise; 0 switches it off
  double dropout = 0.0;  // probability that a beam has no return
};

// An experiment describes one run of the simulator: rig, building, path and noise, what moves
// and what is wrong.
struct Experiment {
  Rig rig;  // as the rig file says; TrueRig(rig, faults) is what measures
  Building building;
  PathOptions path;
  NoiseOptions noise;
  FaultOptions faults;
  MovingOptions moving;
  std::vector<double> scanner_phases_s;  // of each scanner's first scan line, after the start
};

// Reads an experiment file (docs/inputs.md) with the building and the rig that it names,
// relative to its own folder. The section "mapper" holds the mapper's options, which this
// function does not check. Throws Error with file and line.
Experiment ReadExperiment(const std::string& path);

}  // namespace plumbline
