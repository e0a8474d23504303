#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/batch.h"
#include "core/map_state.h"
#include "core/map_types.h"
#include "core/mapper_options.h"
#include "core/plane_covariance.h"
#include "core/progress.h"
#include "core/recording.h"
#include "core/rig.h"
#include "core/window.h"

namespace plumbline {

// What mapping a recording gives, before it is written.
struct MapResult {
  explicit MapResult(MapState state) : state(std::move(state)) {}

  MapState state;
  bool planar = false;
  std::vector<int64_t> scan_times_ns;              // instant of each mapped scan
  std::vector<WindowStatement> window_statements;  // where the options ask for them
  PlaneCovariance window_planes;                   // of the last one
  BatchReport batch;
  std::vector<std::pair<std::string, double>> stages;  // name, seconds
  std::vector<std::string> warnings;
};

// From the scan lines of a recording to the trajectory and the planes: initialisation, scan by
// scan tracking with the window, final batch (docs/architecture.md). Works on the threads of
// the caller's tbb::task_arena, by default all of the machine: they change the time it takes,
// never the result. Throws Error when the motion can not be followed.
MapResult MapRecording(const Rig& rig,
                       const MapperOptions& options,
                       const ProgressCallback& progress,
                       RecordingReader* recording);

// What the variance factor says of a map: a warning where its standard deviations are too
// small by more than 1.7. Throws Error where the scans contradict the map.
std::optional<std::string> JudgeVarianceFactor(double variance_factor);

// The landmarks with observations as plane patches, ids as in the state.
std::vector<PlanePatch> PlanePatches(const MapState& state);

}  // namespace plumbline
