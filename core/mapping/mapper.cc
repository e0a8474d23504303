#include "core/mapping/mapper.h"

#include <glog/logging.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>

#include "core/association/association.h"
#include "core/association/model_frame.h"
#include "core/association/plane_candidates.h"
#include "core/association/plane_merging.h"
#include "core/batch/part_joining.h"
#include "core/estimation/imu_terms.h"
#include "core/following/recording_follower.h"
#include "core/following/scan_follower.h"
#include "core/following/tracker.h"
#include "core/judging/consistency.h"
#include "core/sensor/scan_reader.h"
#include "core/surface/plane_patches.h"
#include "core/util/error.h"
#include "core/util/free_memory.h"
#include "core/util/stopwatch.h"
#include "core/visibility/resegmentation.h"
#include "core/window/window.h"

namespace plumbline {
namespace {

constexpr double kFollowingShare = 0.5;  // of the time, roughly: for progress

// How far the mapping is once a share of the recording is followed, or of the parts estimated.
ProgressState FollowingAt(double share_done) {
  ProgressState state(kFollowingShare * share_done);
  state.stage = "following";
  return state;
}
ProgressState EstimatingAt(double share_done) {
  ProgressState state(kFollowingShare + (1.0 - kFollowingShare) * share_done);
  state.stage = "estimating";
  return state;
}

// The planes of the last window estimate, as they are estimated now.
PlaneCovariance PlanesOf(const std::vector<WindowEstimate>& estimates, const MapState& state) {
  if (estimates.empty()) return {};
  const WindowEstimate& last = estimates.back();
  std::vector<PlanePatch> patches;
  std::vector<int> rows;
  int row = 0;
  for (const PlanePatch& patch : PlanePatches(state.landmarks)) {
    const auto& ids = last.landmark_ids;
    if (std::binary_search(ids.begin(), ids.end(), patch.id)) patches.push_back(patch);
  }
  for (const int id : last.landmark_ids) {
    const Landmark& landmark = state.landmarks[static_cast<size_t>(id)];
    for (int k = 0; k < landmark.num_parameters(); ++k, ++row) {
      if (landmark.num_segments > 0) rows.push_back(row);
    }
  }
  return StatedCovariance(
      state.landmarks, std::move(patches), last.landmark_covariance(rows, rows));
}

// States what was seen where a map could not be estimated, and what to try.
std::string FailureInWords(const std::string& what, const MapState& state) {
  const auto has_plane = [](const Observation& observation) {
    return observation.landmark_id >= 0;
  };
  const auto num_on_planes =
      std::count_if(state.observations.begin(), state.observations.end(), has_plane);
  const auto num_planes = std::count_if(
      state.landmarks.begin(), state.landmarks.end(), [](const Landmark& landmark) {
        return landmark.num_segments > 0;
      });
  return what + " (" + std::to_string(num_on_planes) + " of " +
         std::to_string(state.observations.size()) + " segments lie on " +
         std::to_string(num_planes) +
         " planes). No single map fits the scans: check topics, body_from_scanner and "
         "time_offset_s of each scanner in the rig file, and whether the scanners see walls";
}

// The batch over one part.
MapResult EstimatePart(const Rig& rig,
                       bool planar,
                       const MapperOptions& options,
                       const ProgressCallback& progress,
                       RecordingReader* recording,
                       FollowedPart* part) {
  PlaneCovariance window_planes = PlanesOf(part->window_estimates, part->state);
  MapResult result(std::move(part->state));
  result.window_estimates = std::move(part->window_estimates);
  result.window_planes = std::move(window_planes);
  result.planar = planar;
  result.start_s = part->start_s;
  result.end_s = part->end_s;
  result.ended_by = part->ended_by;
  result.scan_times_ns = std::move(part->scan_times_ns);
  Stopwatch batch_watch;
  {
    const Stopwatch::Running running(&batch_watch);
    ReturnFreeMemoryOfLargeJob();
    try {
      result.batch = EstimateBatch(result.state.calibration.Posed(rig),
                                   planar,
                                   options,
                                   progress,
                                   recording,
                                   &result.state);
    } catch (const Error& error) {
      throw Error(FailureInWords(error.what(), result.state));
    }
  }
  for (const MapGap& gap : result.state.gaps) {
    const std::shared_ptr<const Odometry>& wheels = result.state.odometry;
    const bool by_wheels = wheels != nullptr && wheels->Covers(gap.start_ns, gap.end_ns);
    result.warnings.push_back(
        "nothing is mapped from " +
        FormatSeconds(SecondsBetween(recording->start_ns(), gap.start_ns)) + " to " +
        FormatSeconds(SecondsBetween(recording->start_ns(), gap.end_ns)) + " (" + gap.reason +
        "); what follows has its place by " +
        (by_wheels ? "the wheels" : "the surfaces that both show"));
  }
  if (result.batch.drift_m) {
    char drift[32];
    std::snprintf(drift, sizeof(drift), "%.1f m", *result.batch.drift_m);
    result.warnings.push_back(
        std::string("the rig had drifted by up to ") + drift +
        " where it came back to places it had seen; that is corrected, but stated standard "
        "deviations know nothing of it");
  }
  if (!result.ended_by.empty()) {
    result.warnings.push_back("the map ends " + FormatSeconds(result.end_s) +
                              " into the recording: " + result.ended_by);
  }
  if (const auto warning = JudgeVarianceFactor(result.batch.variance_factor)) {
    result.warnings.push_back(*warning);
  }
  result.stages = {{"batch", batch_watch.seconds() - result.batch.covariance_watch.seconds()},
                   {"covariance", result.batch.covariance_watch.seconds()}};
  return result;
}

// Follows the recording; stages gets the times that takes.
FollowedRecording FollowRecording(const Rig& rig,
                                  bool planar,
                                  const MapperOptions& options,
                                  const ProgressCallback& progress,
                                  RecordingReader* recording,
                                  const std::function<bool()>& stop,
                                  std::vector<std::pair<std::string, double>>* stages) {
  Stopwatch tracking_watch;
  RecordingFollower recording_follower(rig, planar, options, recording);
  std::vector<FollowerOfPart> parts;
  {
    const Stopwatch::Running running(&tracking_watch);
    parts = recording_follower.Run([&](double share) { progress(FollowingAt(share)); }, stop);
  }
  double segmentation_s = 0.0;
  FollowedRecording followed;
  followed.num_skipped = recording_follower.num_skipped();
  followed.left_out = recording_follower.left_out();
  for (FollowerOfPart& part : parts) {
    ScanFollower& follower = part.follower->follower();
    segmentation_s += follower.segmentation_watch().seconds();
    FollowedPart& moved = followed.parts.emplace_back(std::move(follower.state()));
    moved.scan_times_ns = follower.scan_times_ns();
    moved.window_estimates = follower.estimates();
    moved.start_s = part.start_s;
    moved.end_s = part.end_s;
    moved.ended_by = part.ended_by;
    part.follower.reset();
  }
  *stages = {{"segmentation", segmentation_s},
             {"window", tracking_watch.seconds() - segmentation_s}};
  return followed;
}

// A map does not fail for want of a checkpoint.
void KeepCheckpoint(const CheckpointFiles& checkpoint, FollowedRecording* followed) {
  try {
    WriteCheckpoint(checkpoint.inputs, checkpoint.write_to, followed);
  } catch (const Error& error) {
    LOG(WARNING) << "no checkpoint for --resume: " << error.what();
  }
}

// The maps of all parts that can be estimated; throws Error where there is none. The longest
// one's warnings name a part that can not.
std::vector<MapResult> EstimateParts(const Rig& rig,
                                     bool planar,
                                     const MapperOptions& options,
                                     const ProgressCallback& progress,
                                     RecordingReader* recording,
                                     std::vector<FollowedPart>* parts) {
  std::vector<MapResult> results;
  std::string failed;
  const auto num_parts = static_cast<double>(parts->size());
  for (size_t i = 0; i < parts->size(); ++i) {
    FollowedPart& part = (*parts)[i];
    try {
      results.push_back(EstimatePart(
          rig,
          planar,
          options,
          [&](double share) {
            const double done = (static_cast<double>(i) + share) / num_parts;
            progress(EstimatingAt(done));
          },
          recording,
          &part));
    } catch (const Error& error) {
      failed = "the part from " + FormatSeconds(part.start_s) + " to " +
               FormatSeconds(part.end_s) + " could not be estimated: " + error.what();
      if (parts->size() == 1) throw Error(failed);
      LOG(WARNING) << failed;
    }
  }
  if (results.empty()) throw Error(failed);
  if (!failed.empty()) results[LongestPart(results)].warnings.push_back(failed);
  return results;
}

// The maps of the recording's parts, joined where they match. Where the scans contradict what
// was joined, the parts stay apart.
std::vector<MapResult> EstimateJoined(const Rig& rig,
                                      bool planar,
                                      const MapperOptions& options,
                                      const ProgressCallback& progress,
                                      RecordingReader* recording,
                                      FollowedRecording* followed) {
  const bool may_join = followed->parts.size() > 1 && !options.window.keep_estimates;
  if (may_join) {
    FollowedRecording joined = *followed;
    JoinParts(rig, planar, &joined);
    if (joined.parts.size() < followed->parts.size()) {
      const size_t num_parts = joined.parts.size();
      try {
        std::vector<MapResult> results =
            EstimateParts(rig, planar, options, progress, recording, &joined.parts);
        if (results.size() == num_parts) return results;
      } catch (const Error& error) {
        LOG(WARNING) << "the parts are not joined: " << error.what();
      }
    }
  }
  return EstimateParts(rig, planar, options, progress, recording, &followed->parts);
}

}  // namespace

size_t LongestPart(const std::vector<MapResult>& parts) {
  const auto has_less_scans = [](const MapResult& a, const MapResult& b) {
    return a.scan_times_ns.size() < b.scan_times_ns.size();
  };
  return static_cast<size_t>(std::max_element(parts.begin(), parts.end(), has_less_scans) -
                             parts.begin());
}

std::vector<MapResult> MapRecording(const Rig& rig,
                                    const MapperOptions& stated_options,
                                    const ProgressCallback& progress,
                                    RecordingReader* recording,
                                    const std::function<bool()>& stop,
                                    const CheckpointFiles& checkpoint) {
  stated_options.Check();
  const bool planar = IsPlanar(rig);
  const bool has_imu = recording->imu() != nullptr;
  const MapperOptions options =
      has_imu && !planar ? WithoutMotionPrior(stated_options) : stated_options;
  if (planar) {
    LOG(INFO)
        << "planar rig: all scan planes are horizontal, so height, roll and pitch can not "
           "be seen; estimating the planar motion";
  }
  std::vector<std::pair<std::string, double>> stages;
  FollowedRecording followed =
      checkpoint.read_from.empty()
          ? FollowRecording(rig, planar, options, progress, recording, stop, &stages)
          : ReadCheckpoint(checkpoint.inputs, checkpoint.read_from);
  for (FollowedPart& part : followed.parts) {
    if (options.odometry.enabled) part.state.odometry = recording->odometry();
    part.state.imu = recording->imu();
    if (part.state.calibration.imu) part.state.calibration.imu->stated = *rig.imu;
  }
  double following_s = 0.0;
  for (const auto& [stage, seconds] : stages) following_s += seconds;
  if (!checkpoint.write_to.empty() && following_s >= checkpoint.after_s) {
    KeepCheckpoint(checkpoint, &followed);
  }
  std::vector<MapResult> results =
      EstimateJoined(rig, planar, options, progress, recording, &followed);
  MapResult& main = results[LongestPart(results)];
  for (const std::string& left_out : followed.left_out) main.warnings.push_back(left_out);
  if (followed.num_skipped > 0) {
    main.warnings.push_back("the first " + std::to_string(followed.num_skipped) +
                            " scans are left out: they do not show " +
                            (planar ? "a wall" : "floor or ceiling and a wall") +
                            " clearly enough");
  }
  main.stages.insert(main.stages.begin(), stages.begin(), stages.end());
  return results;
}

std::optional<std::string> JudgeVarianceFactor(double variance_factor) {
  constexpr double kAstray = 25.0;  // the square of 5
  if (variance_factor < kDoubtfulVarianceFactor) return std::nullopt;
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
