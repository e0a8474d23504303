#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/judging/scanner_agreement.h"
#include "core/map/map_state.h"
#include "core/result/result_types.h"
#include "core/sensor/rig.h"

namespace plumbline {

// The judgement on a finished map, and warnings for the user of what is no doubt at an
// interval.
struct ConsistencyReport {
  Consistency consistency;
  std::optional<Cause> cause;  // none of a consistent map
  std::vector<std::string> warnings;
};

// Variance factor beyond which stated standard deviations are too small, and below whose
// inverse they are too large: the square of 1.7.
inline constexpr double kDoubtfulVarianceFactor = 3.0;

// A finished map, as the batch leaves it.
struct FinishedMap {
  bool planar = false;
  const MapState& state;
  double variance_factor = 1.0;
  // The second of the recording in which the map begins. All that is collected by second
  // counts from there: a recording may have lasted for days before it.
  int first_second = 0;
  // Stated standard deviation of the position, m, in the worst direction, by second since
  // first_second.
  std::vector<double> position_stddevs_m;
};

// Judges a finished map by what it says of itself, since a wrong map can explain every
// segment by planes of its own and still have small residuals (docs/robustness.md):
//   - beams that pass through what was a surface at other times,
//   - surfaces that are doubled, never seen together,
//   - places that a later visit sees shifted,
//   - poses that jump,
//   - segments without planes,
//   - scanners that contradict the others,
//   - positions that are hardly known, by the covariance that is stated,
//   - wheels that count another way than the map has, where nothing else shows it,
//   - an IMU that reads another motion than the map has.
// start_ns: of the recording. Works on the threads of the caller's tbb::task_arena.
ConsistencyReport JudgeConsistency(const Rig& rig,
                                   const FinishedMap& map,
                                   const ScannerActivity& activity,
                                   int64_t start_ns);

}  // namespace plumbline
