#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/sensor/rig.h"
#include "core/util/yaml_node.h"
#include "simulation/world/unevenness.h"

namespace plumbline {

// Probabilities that a pane returns a beam or lets it pass; else there is no return.
struct GlassOptions {
  double returns = 0.1;  // from the pane
  double passes = 0.8;   // through this pane and all others
};

// For some time a scanner does not measure.
struct Episode {
  enum class Kind {
    kGone,      // no messages
    kFrozen,    // the last ranges again and again, with new stamps
    kInfinite,  // no beam has a return
    kRandom,    // uniform ranges
  };
  Kind kind = Kind::kGone;
  double from_s = 0.0;  // since the recording's begin
  double to_s = 0.0;
};

// ScannerFaults say how one scanner differs from what the rig file says, which the recording's
// rig.yaml goes on saying.
struct ScannerFaults {
  double range_bias_m = 0.0;  // added to every range, which is multiplied by the scale before
  double range_scale = 1.0;
  double clock_late_s = 0.0;  // added to every stamp
  // It is mounted elsewhere: turned about the axes of the body, and moved.
  Eigen::Quaterniond rotation_error = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_error = Eigen::Vector3d::Zero();  // m
  bool mirrored = false;  // its beams come in the order of the other sense of rotation
  double unit_m = 1.0;    // in which the recording has the ranges
  std::vector<Episode> episodes;
};

// FaultOptions are all errors beyond the noise that the mapper reckons with.
struct FaultOptions {
  double outliers = 0.0;      // share of the beams with any range whatever
  double mixed_pixels = 0.0;  // probability, at an edge in depth, of a range in between
  GlassOptions glass;
  UnevennessOptions surfaces;
  std::vector<int> swapped;             // two scanners whose topics are exchanged, or none
  std::vector<ScannerFaults> scanners;  // one for each of the rig's; or none
};

// Reads the section "faults" of an experiment. Throws Error with file and line.
FaultOptions ReadFaults(const YamlNode& node, const Rig& rig);

// The rig as it is, where the rig file says something else.
Rig TrueRig(const Rig& rig, const FaultOptions& faults);

}  // namespace plumbline
