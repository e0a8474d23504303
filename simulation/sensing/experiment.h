#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/sensor/rig.h"
#include "simulation/sensing/faults.h"
#include "simulation/sensing/inertial.h"
#include "simulation/sensing/mounts.h"
#include "simulation/sensing/wheels.h"
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
  // As the rig file says, and with the topic of wheels; TrueRig(rig, faults) is what measures.
  Rig rig;
  Building building;
  PathOptions path;
  NoiseOptions noise;
  FaultOptions faults;
  MovingOptions moving;
  std::optional<WheelOptions> wheels;    // none: the recording has no odometry
  std::optional<InertialOptions> inertial;  // none: the recording has no IMU
  MountOptions mounts;
  std::vector<double> scanner_phases_s;  // of each scanner's first scan line, after the start
};

// Reads an experiment file (docs/inputs.md) with the building and the rig that it names,
// relative to its own folder. The section "mapper" holds the mapper's options, which this
// function does not check. Throws Error with file and line.
Experiment ReadExperiment(const std::string& path);

}  // namespace plumbline
