#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/sensor/rig.h"
#include "core/util/yaml_node.h"

namespace plumbline {

// MountOptions say how the mounts of the rig file are simulated.
struct MountOptions {
  double rate_hz = 100.0;  // of the messages with angles
  // Of all errors that the rig file states: zero, clock, rate, axis. 0: as it states.
  double errors = 1.0;
  // Standard deviation of a read angle; of a mount whose angle no topic tells, of the mount
  // itself about its drive, from one fiftieth of a second to the next. jitter_deg in the file.
  double jitter_rad = 0.0;
  // The scanner follows its drive, whose angle is read, with this much play. backlash_deg in
  // the file.
  double backlash_rad = 0.0;
};

// Reads the section "mounts" of an experiment. Throws Error with file and line.
MountOptions ReadMountOptions(const YamlNode& node);

// What a mount is off the rig file by.
struct MountTruth {
  std::string scanner;
  double zero_rad = 0.0;
  double late_s = 0.0;                               // angles are taken later than stamped
  double rate = 0.0;                                 // share by which the drive is faster
  Eigen::Vector2d tilts = Eigen::Vector2d::Zero();   // of the axis, rad
  Eigen::Vector2d shifts = Eigen::Vector2d::Zero();  // of the axis, m
};

// MountReading is an angle as it is recorded.
struct MountReading {
  int64_t stamp_ns = 0;
  size_t scanner = 0;
  double angle_rad = 0.0;
};

// Mounts as they are: their motion from end to end of a recording, and what is read of it. The
// random numbers depend only on the seed and the scanner.
struct SimulatedMounts {
  std::vector<MountTruth> truths;      // of the scanners on mounts
  std::vector<MountReading> readings;  // by stamp
};

// Sets the mounts of a rig that measures from start_ns to end_ns to what they truly are: their
// angles are those of a table, whatever tells them in the recording. first_line_ns: stamp of
// the recording's first scan line, from which drives count.
SimulatedMounts SimulateMounts(const MountOptions& options,
                               int64_t first_line_ns,
                               int64_t start_ns,
                               int64_t end_ns,
                               uint64_t seed,
                               Rig* rig);

// The truth as truth_mounts.json: by scanner the parameters of calibration.json.
std::string FormatMountTruth(const std::vector<MountTruth>& truths);

}  // namespace plumbline
