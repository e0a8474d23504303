#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/sensor/odometry.h"
#include "core/util/yaml_node.h"
#include "simulation/world/path.h"

namespace plumbline {

// WheelOptions say how wheels count the rig's way, and how wrongly.
struct WheelOptions {
  std::string topic = "/odom";
  double rate_hz = 50.0;
  // Counts for one metre of way, and for one radian of turn; negative: the other way round.
  double length_scale = 1.0;
  double turn_scale = 1.0;
  // Standard deviations of both after one metre of way; they grow with its square root.
  double length_noise_m = 0.0;
  double turn_noise_rad = 0.0;
  // Number of slips a metre, at random places. For slip_s seconds the wheels count slip_share
  // more than the rig goes.
  double slips_per_m = 0.0;
  double slip_share = 0.5;
  double slip_s = 0.3;
  double clock_late_s = 0.0;  // added to the stamps
  // Number of times a second, at random, from which on a pose is sent again for stale_s.
  double stale_per_s = 0.0;
  double stale_s = 0.2;
};

// Reads the section "odometry" of an experiment. Throws Error with file and line.
WheelOptions ReadWheels(const YamlNode& node);

// Returns the odometry of the whole path: poses seen from above, in the wheels' own frame,
// which begins at the path's first pose. The random numbers depend only on the seed.
std::vector<OdometrySample> WheelSamples(const Path& path,
                                         const WheelOptions& options,
                                         uint64_t seed);

}  // namespace plumbline
