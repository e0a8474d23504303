#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace plumbline {

// One 2D laser scanner of the rig: where it sits, how well it measures.
struct Scanner {
  std::string name;
  std::string topic;  // of its sensor_msgs/LaserScan messages
  Rigid3d body_from_scanner;
  double range_noise_m = 0.03;  // standard deviation of one range
  // Standard deviation of a beam's direction; angle_noise_deg in the file, 0.005 deg by
  // default.
  double angle_noise_rad = 0.005 * M_PI / 180.0;
  double min_range_m = 0.1;
  double max_range_m = 30.0;
  double time_offset_s = 0.0;  // beam time = stamp + index * time_increment + time_offset

  // What only the simulator needs; when mapping, the recording's own values count.
  int beams = 270;
  double field_of_view_deg = 270.0;
  double scan_rate_hz = 40.0;

  bool IsValidRange(double range) const {
    return std::isfinite(range) && range >= min_range_m && range <= max_range_m;
  }
};

// The motion that the mapper estimates. kAutomatic: planar when every scan plane is horizontal
// in the body frame (height, roll and pitch can not be observed then), spatial otherwise.
enum class MotionModel { kAutomatic, kSpatial, kPlanar };

struct Rig {
  MotionModel motion = MotionModel::kAutomatic;
  std::vector<Scanner> scanners;
};

// Reads a rig file (docs/inputs.md). Throws Error with file and line.
Rig ReadRig(const std::string& path);

// Writes a rig file that ReadRig understands.
void WriteRig(const Rig& rig, const std::string& path);

// Whether only the planar motion is estimated: by the rig file, or because all scan planes are
// horizontal and see no heights.
bool IsPlanar(const Rig& rig);
// True when every scan plane is horizontal in the body frame to within tolerance_rad.
bool AllScannersHorizontal(const Rig& rig, double tolerance_rad);

// The largest range noise of a rig's scanners.
double MaxRangeNoise(const Rig& rig);

}  // namespace plumbline
