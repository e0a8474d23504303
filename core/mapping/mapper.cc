#include "core/mapping/mapper.h"

#include <glog/logging.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "core/association/association.h"
#include "core/association/model_frame.h"
#include "core/association/plane_candidates.h"
#include "core/association/plane_merging.h"
#include "core/map/plane_patches.h"
#include "core/mapping/scan_follower.h"
#include "core/sensor/scan_reader.h"
#include "core/tracking/tracker.h"
#include "core/util/error.h"
#include "core/util/free_memory.h"
#include "core/util/stopwatch.h"
#include "core/visibility/resegmentation.h"
#include "core/window/window.h"

namespace plumbline {
namespace {

constexpr double kFollowingShare = 0.5;  // of the time, roughly: for progress

// Takes the recording scan by scan, up to its end or a gap that can not be bridged. Throws
// Error when there is no start or the pose is lost.
void FollowRecording(const Rig& rig,
                     bool planar,
                     const MapperOptions& options,
                     const ProgressCallback& progress,
                     RecordingReader* recording,
                     ScanFollower* follower,
                     std::vector<std::string>* warnings) {
  const double duration_s =
      std::max(1e-9, SecondsBetween(recording->start_ns(), recording->end_ns()));
  int num_skipped = 0;
  ScanReader scans(rig, recording);
  Scan scan;
  int64_t previous_end_ns = 0;
  while (scans.Next(&scan)) {
    const double now_s = SecondsBetween(recording->start_ns(), scan.start_ns);
    progress(kFollowingShare * now_s / duration_s);
    if (!follower->started()) {
      if (!follower->Start(scan)) {
        ++num_skipped;
        if (now_s > options.tracking.max_start_search_s) break;
      }
    } else if (SecondsBetween(previous_end_ns, scan.start_ns) > options.max_gap_s) {
      warnings->push_back("the map ends " + FormatSeconds(now_s) +
                          " into the recording: no scans for " +
                          FormatSeconds(SecondsBetween(previous_end_ns, scan.start_ns)) +
                          ", a gap the motion can not be followed across");
      break;
    } else {
      follower->Follow(scan);
    }
    previous_end_ns = scan.end_ns;
  }
  if (!follower->started()) {
    throw Error(
        "no start: none of the first " + std::to_string(num_skipped) + " scans shows " +
        (planar ? "a wall clearly enough" : "floor or ceiling and a wall clearly enough"));
  }
  if (num_skipped > 0) {
    warnings->push_back(
        "the first " + std::to_string(num_skipped) + " scans are left out: they do not show " +
        (planar ? "a wall" : "floor or ceiling and a wall") + " clearly enough");
  }
}

// The planes of the last window estimate, as they are estimated now.
PlaneCovariance PlanesOf(const std::vector<WindowEstimate>& estimates, const MapState& state) {
  if (estimates.empty()) return {};
  const WindowEstimate& last = estimates.back();
  std::vector<PlanePatch> patches;
  std::vector<int> rows;
  int row = 0;
  for (const PlanePatch& patch : PlanePatches(state)) {
    const auto& ids = last.landmark_ids;
    if (std::binary_search(ids.begin(), ids.end(), patch.id)) patches.push_back(patch);
  }
  for (const int id : last.landmark_ids) {
    const Landmark& landmark = state.landmarks[static_cast<size_t>(id)];
    for (int k = 0; k < landmark.num_parameters(); ++k, ++row) {
      if (landmark.num_segments > 0) rows.push_back(row);
    }
  }
  return {std::move(patches), last.landmark_covariance(rows, rows)};
}

}  // namespace

MapResult MapRecording(const Rig& rig,
                       const MapperOptions& options,
                       const ProgressCallback& progress,
                       RecordingReader* recording) {
  options.Check();
  const bool planar = IsPlanar(rig);
  std::vector<std::string> warnings;
  if (planar) {
    LOG(INFO)
        << "planar rig: all scan planes are horizontal, so height, roll and pitch can not "
           "be seen; estimating the planar motion";
  }
  Stopwatch tracking_watch;
  Stopwatch batch_watch;
  ScanFollower follower(rig, planar, options, recording->scan_period_s());
  {
    const Stopwatch::Running running(&tracking_watch);
    FollowRecording(rig, planar, options, progress, recording, &follower, &warnings);
  }
  PlaneCovariance window_planes = PlanesOf(follower.estimates(), follower.state());
  MapResult result(std::move(follower.state()));
  result.window_estimates = follower.estimates();
  result.window_planes = std::move(window_planes);
  result.planar = planar;
  result.scan_times_ns = follower.scan_times_ns();
  result.warnings = std::move(warnings);
  {
    const Stopwatch::Running running(&batch_watch);
    ReturnFreeMemoryOfLargeJob();
    result.batch = EstimateBatch(
        rig,
        planar,
        options,
        [&](double share) { progress(kFollowingShare + (1.0 - kFollowingShare) * share); },
        recording,
        &result.state);
  }
  if (const auto warning = JudgeVarianceFactor(result.batch.variance_factor)) {
    result.warnings.push_back(*warning);
  }
  result.stages = {
      {"segmentation", follower.segmentation_watch().seconds()},
      {"window", tracking_watch.seconds() - follower.segmentation_watch().seconds()},
      {"batch", batch_watch.seconds() - result.batch.covariance_watch.seconds()},
      {"covariance", result.batch.covariance_watch.seconds()}};
  return result;
}

std::optional<std::string> JudgeVarianceFactor(double variance_factor) {
  constexpr double kDoubtful = 3.0;  // the square of 1.7
  constexpr double kAstray = 25.0;   // the square of 5
  if (variance_factor < kDoubtful) return std::nullopt;
  char ratio[32];
  std::snprintf(ratio, sizeof(ratio), "%.1f", std::sqrt(variance_factor));
  const std::string what = "the scans deviate from the planes " + std::string(ratio) +
                           " times as far as the rig file's noise says: ";
  if (variance_factor > kAstray) {
    throw Error(what +
                "the estimate has gone astray, or range_noise_m in the rig file is wrong");
  }
  return what + "stated standard deviations are too small by as much";
}

}  // namespace plumbline
