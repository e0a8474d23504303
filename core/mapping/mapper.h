#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/batch/batch.h"
#include "core/following/checkpoint.h"
#include "core/map/map_state.h"
#include "core/options/mapper_options.h"
#include "core/result/plane_covariance.h"
#include "core/result/result_types.h"
#include "core/sensor/recording.h"
#include "core/sensor/rig.h"
#include "core/util/progress.h"
#include "core/window/window.h"

namespace plumbline {

// The map of a recording, or of one part of it, before it is written.
struct MapResult {
  explicit MapResult(MapState state) : state(std::move(state)) {}

  MapState state;
  bool planar = false;
  double start_s = 0.0;  // of the mapped time, since the recording's start
  double end_s = 0.0;
  std::string ended_by;  // a sentence where the map ends before the recording; else empty
  std::vector<int64_t> scan_times_ns;            // instant of each mapped scan
  std::vector<WindowEstimate> window_estimates;  // where the options ask for them
  PlaneCovariance window_planes;                 // of the last one
  BatchReport batch;
  std::vector<std::pair<std::string, double>> stages;  // name, seconds
  std::vector<std::string> warnings;
};

// Paths of the checkpoint between following and batch.
struct CheckpointFiles {
  MapInputs inputs;
  std::string write_to;   // empty: not kept
  double after_s = 0.0;   // kept where following took at least this time
  std::string read_from;  // instead of following the recording; empty: none
};

// Estimates the trajectory and the planes from the scan lines of a recording: initialisation,
// tracking scan by scan with the window, final batch (docs/architecture.md). Works on the
// threads of the caller's tbb::task_arena, by default all of the machine: their number changes
// the time that the mapping takes, never the result.
//
// Where the rig is lost, or no scan comes for longer than the motion can be followed across,
// the map ends, and another part with a model frame of its own starts where the scans allow.
// Parts whose surfaces match are joined to one map (core/batch/part_joining.h).
// Returns the parts in the order of time, at least one. stop, if given, is asked at every
// scan: once it says true, the recording is not followed any farther. Throws Error when there
// is no part.
std::vector<MapResult> MapRecording(const Rig& rig,
                                    const MapperOptions& options,
                                    const ProgressCallback& progress,
                                    RecordingReader* recording,
                                    const std::function<bool()>& stop = {},
                                    const CheckpointFiles& checkpoint = {});

// The part that holds the most scans.
size_t LongestPart(const std::vector<MapResult>& parts);

// Judges a map by its variance factor: returns a warning where the standard deviations are too
// small by more than 1.7, and throws Error where the scans contradict the map.
std::optional<std::string> JudgeVarianceFactor(double variance_factor);

}  // namespace plumbline
