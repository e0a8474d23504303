#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/judging/scanner_agreement.h"
#include "core/map/map_state.h"
#include "core/result/result_writer.h"
#include "core/sensor/recording.h"
#include "core/sensor/rig.h"
#include "core/util/progress.h"

namespace plumbline {

// PointReport says how well the points of a recording agree with a map.
struct PointReport {
  int64_t num_points = 0;       // valid ranges in the recording
  int64_t num_used = 0;         // of these on planes' segments and sub-minimum segments
  int64_t num_moving = 0;       // on things that move
  double residual_rms_m = 0.0;  // of what is used
  ScannerActivity activity;
  std::vector<std::string> warnings;
};

// The second of a recording that began at start_ns in which a map begins; what is collected by
// second counts from there, since days may have passed before it.
int FirstSecond(const MapState& state, int64_t start_ns);

// Reads the recording once more and writes every valid point at its place in the map, so that
// no points had to be kept. Works on the threads of the caller's tbb::task_arena.
PointReport ExportPoints(const Rig& rig,
                         const MapState& state,
                         const ProgressCallback& progress,
                         RecordingReader* recording,
                         ResultWriter* writer);

}  // namespace plumbline
