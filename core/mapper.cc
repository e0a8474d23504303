#include "core/mapper.h"

#include <glog/logging.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "core/association.h"
#include "core/candidates.h"
#include "core/duplicates.h"
#include "core/error.h"
#include "core/free_memory.h"
#include "core/initialisation.h"
#include "core/scan_reader.h"
#include "core/segment_ends.h"
#include "core/stopwatch.h"
#include "core/tracker.h"
#include "core/window.h"

namespace plumbline {
namespace {

// Beyond these standard deviations, the planes given, the newest pose is lost.
constexpr double kLostPosition = 0.5;                  // m
constexpr double kLostRotation = 10.0 * M_PI / 180.0;  // rad
constexpr double kMaxStartSearch = 5.0;  // s, in which a scan must show the model frame
constexpr double kFollowingShare = 0.5;  // of the time, roughly: for progress

// Follows the rig scan by scan: segmentation, tracking, new planes, window.
class Follower {
 public:
  Follower(const Rig& rig, bool planar, const MapperOptions& options, double scan_period_s)
      : rig_(rig),
        planar_(planar),
        options_(options),
        scan_period_s_(scan_period_s),
        candidates_(planar, options) {}

  bool started() const { return window_ != nullptr; }
  MapState& state() { return *state_; }
  const std::vector<int64_t>& scan_times_ns() const { return scan_times_ns_; }
  const std::vector<WindowStatement>& statements() const { return window_->statements(); }
  Stopwatch& segmentation_watch() { return segmentation_watch_; }

  // Looks for the model frame in this scan; false when it does not show.
  bool Start(const Scan& scan);
  // Takes the next scan. Throws Error when the pose is lost.
  void Follow(const Scan& scan);

 private:
  std::vector<Observation> Observe(const Scan& scan);
  ScannerMotion PredictMotion(const ScanLine& scan_line) const;
  void Accept(int observation_index, bool tracked);
  void Judge(const Observation& observation);
  void StartPlanes(int min_scans);
  bool ShadowsLandmark(const PlaneCandidate& candidate) const;
  void AddLandmark(PlaneCandidate candidate);
  void SolveWindow(int64_t now_ns);
  void CheckNotLost(int64_t now_ns);

  const Rig& rig_;
  bool planar_;
  const MapperOptions& options_;
  double scan_period_s_;
  CandidatePlanes candidates_;
  std::unique_ptr<MapState> state_;
  std::unique_ptr<Window> window_;
  std::unique_ptr<Tracker> tracker_;
  std::vector<int64_t> scan_times_ns_;
  std::optional<SharedPoses> poses_;  // of the trajectory as the newest scan leaves it
  int64_t last_known_ns_ = 0;         // when the pose was last well determined
  int last_solved_interval_ = -1;
  int last_solved_scan_ = 0;
  Stopwatch segmentation_watch_;
};

ScannerMotion Follower::PredictMotion(const ScanLine& scan_line) const {
  ScannerMotion motion;
  if (!started()) return motion;
  const int64_t time_ns = BeamInstant(scan_line, scan_line.num_beams() / 2, rig_);
  Eigen::Vector3d angular_world;
  Eigen::Vector3d linear_world;
  state_->trajectory.Velocity(time_ns, &angular_world, &linear_world);
  const Rigid3d world_from_body = state_->trajectory.WorldFromBody(time_ns);
  const Rigid3d& body_from_scanner =
      rig_.scanners[static_cast<size_t>(scan_line.scanner_index)].body_from_scanner;
  const Eigen::Quaterniond scanner_from_world =
      (world_from_body.rotation * body_from_scanner.rotation).conjugate();
  const Eigen::Vector3d arm_world = world_from_body.rotation * body_from_scanner.translation;
  const Eigen::Vector3d linear =
      scanner_from_world * (linear_world + angular_world.cross(arm_world));
  motion.velocity_m_s = linear.head<2>();
  motion.yaw_rate_rad_s = (scanner_from_world * angular_world).z();
  return motion;
}

std::vector<Observation> Follower::Observe(const Scan& scan) {
  const Stopwatch::Running running(&segmentation_watch_);
  const size_t num_lines = scan.scan_lines.size();
  std::vector<std::vector<Observation>> found(num_lines);
  tbb::parallel_for(size_t{0}, num_lines, [&](size_t i) {
    const ScanLine& scan_line = scan.scan_lines[i];
    const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
    for (const Segment& segment : SegmentScanLine(
             scan_line, scanner, PredictMotion(scan_line), options_.segmentation)) {
      found[i].push_back(MakeObservation(
          scan_line, scanner, segment, options_.batch.factor == FactorKind::kPoint));
      found[i].back().scan_line_index = scan.scan_line_indices[i];
    }
  });
  std::vector<Observation> observations;
  for (std::vector<Observation>& line : found) {
    for (Observation& observation : line) {
      observation.scan_index = static_cast<int>(scan_times_ns_.size());
      observations.push_back(std::move(observation));
    }
  }
  return observations;
}

bool Follower::Start(const Scan& scan) {
  std::vector<Observation> observations = Observe(scan);
  const std::optional<ModelFrame> frame = FindModelFrame(rig_, planar_, observations);
  if (!frame) return false;
  const double interval_s = std::max(options_.trajectory.knot_interval_s,
                                     options_.trajectory.min_scans_per_knot * scan_period_s_);
  // Later scan lines may lie before this one by their scanners' time offsets.
  double earliest_s = 0.0;
  for (const Scanner& scanner : rig_.scanners) {
    earliest_s = std::min(earliest_s, 2.0 * scanner.time_offset_s);
  }
  Trajectory trajectory(scan.start_ns + NanosecondsFromSeconds(earliest_s),
                        NanosecondsFromSeconds(interval_s),
                        {frame->world_from_body, Eigen::Vector3d::Zero()});
  state_ = std::make_unique<MapState>(MapState{trajectory, {}, {}, scan.start_ns, {}});
  state_->trajectory.ExtendTo(scan.end_ns);
  window_ = std::make_unique<Window>(rig_, planar_, options_, state_.get());
  tracker_ = std::make_unique<Tracker>(rig_, planar_, options_, state_.get());
  scan_times_ns_.push_back(scan.start_ns);
  last_known_ns_ = scan.end_ns;

  for (Observation& observation : observations) {
    state_->observations.push_back(std::move(observation));
  }
  poses_.emplace(rig_, state_->trajectory);
  // One scan must do for a start: its segments become planes at once, the first wall first.
  const auto offer = [&](int index) {
    const Observation& observation = state_->observations[static_cast<size_t>(index)];
    candidates_.Offer(observation, index, poses_->Of(observation), Matrix6d::Zero());
  };
  offer(frame->reference_observation);
  const int num_observations = static_cast<int>(state_->observations.size());
  for (int index = 0; index < num_observations; ++index) {
    if (index != frame->reference_observation) offer(index);
  }
  StartPlanes(1);
  Landmark& first_wall = state_->landmarks.front();
  CHECK(first_wall.model == PlaneModel::kVertical);
  first_wall.heading_fixed = true;
  first_wall.parameters[0] = 0.0;
  SolveWindow(scan.end_ns);
  return true;
}

void Follower::Accept(int observation_index, bool tracked) {
  const Observation& observation =
      state_->observations[static_cast<size_t>(observation_index)];
  CountObservation(observation, poses_->Of(observation), state_.get());
  window_->Add(observation_index);
  if (!tracked) tracker_->Add(observation_index);
}

// Takes down how an observation agrees with its landmark.
void Follower::Judge(const Observation& observation) {
  Landmark& landmark = state_->landmarks[static_cast<size_t>(observation.landmark_id)];
  if (landmark.IsJudged()) return;
  for (const PossibleLandmark& on : PossibleLandmarks(
           observation,
           poses_->Of(observation),
           tracker_->pose_uncertainty().At(state_->trajectory, observation.middle_time_ns()),
           {LandmarkCandidate(landmark)},
           options_.association)) {
    landmark.Judge(on.distance2);
  }
}

void Follower::AddLandmark(PlaneCandidate candidate) {
  candidate.landmark.id = static_cast<int>(state_->landmarks.size());
  state_->landmarks.push_back(std::move(candidate.landmark));
  for (const int index : candidate.observations) {
    state_->observations[static_cast<size_t>(index)].landmark_id = state_->landmarks.back().id;
    Accept(index, false);
  }
}

bool Follower::ShadowsLandmark(const PlaneCandidate& candidate) const {
  const int scan_index = static_cast<int>(scan_times_ns_.size()) - 1;
  return std::any_of(
      state_->landmarks.begin(), state_->landmarks.end(), [&](const Landmark& landmark) {
        return landmark.num_segments > 0 &&
               IsWithinGap(landmark, scan_index, options_.loop_closure) &&
               IsShadow(candidate.landmark, landmark, MaxRangeNoise(rig_));
      });
}

void Follower::StartPlanes(int min_scans) {
  for (PlaneCandidate& candidate : candidates_.TakeReady(min_scans)) {
    // An observation that served two candidates belongs to the one that came first.
    std::vector<int>& indices = candidate.observations;
    indices.erase(
        std::remove_if(indices.begin(),
                       indices.end(),
                       [&](int index) {
                         return state_->observations[static_cast<size_t>(index)].landmark_id >=
                                0;
                       }),
        indices.end());
    if (static_cast<int>(indices.size()) < min_scans || ShadowsLandmark(candidate)) continue;
    AddLandmark(std::move(candidate));
  }
}

void Follower::SolveWindow(int64_t now_ns) {
  const double window_s = options_.window.num_scans * scan_period_s_;
  tracker_->Reset(now_ns, window_->Solve(now_ns, window_s));
  for (const auto& [into, from] : FindDuplicates(rig_, *state_, options_, last_solved_scan_)) {
    const Landmark& older = state_->landmarks[static_cast<size_t>(into)];
    if (older.num_segments == 0) continue;
    if (!MayBeTakenUp(older, last_solved_scan_, options_.loop_closure)) continue;
    window_->MergeLandmarks(into, from);
    MergeInto(into, from, state_.get());
  }
  last_solved_interval_ = state_->trajectory.Locate(now_ns).first;
  last_solved_scan_ = static_cast<int>(scan_times_ns_.size()) - 1;
}

void Follower::CheckNotLost(int64_t now_ns) {
  const Matrix6d covariance = tracker_->pose_uncertainty().At(state_->trajectory, now_ns);
  const double rotation = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
  const double position = std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
  if (position < kLostPosition && rotation < kLostRotation) {
    last_known_ns_ = now_ns;
    return;
  }
  // A few blind scans may be bridged, just as missing ones.
  if (SecondsBetween(last_known_ns_, now_ns) < options_.max_gap_s) return;
  char text[200];
  std::snprintf(text,
                sizeof(text),
                "lost track of the rig %.3f s after the start of the map: the planes in view "
                "leave its pose open by %.2f m and %.1f deg",
                SecondsBetween(state_->origin_time_ns, last_known_ns_),
                position,
                rotation * 180.0 / M_PI);
  throw Error(text);
}

void Follower::Follow(const Scan& scan) {
  state_->trajectory.ExtendTo(scan.end_ns);
  const int first = static_cast<int>(state_->observations.size());
  const int scan_index = static_cast<int>(scan_times_ns_.size());
  for (Observation& observation : Observe(scan)) {
    state_->observations.push_back(std::move(observation));
  }
  scan_times_ns_.push_back(scan.start_ns);
  const int last = static_cast<int>(state_->observations.size()) - 1;
  tracker_->Track(first, last, {state_->landmarks, scan_index, options_.loop_closure});
  CheckNotLost(scan.end_ns);
  // Where an unsteady rig was, and so where planes meet, is hardly known.
  if (options_.window.recut_segments && tracker_->IsSteady(scan.end_ns)) {
    RecutScan(rig_,
              options_,
              scan,
              static_cast<size_t>(first),
              tracker_->pose_uncertainty().At(state_->trajectory, scan.end_ns),
              state_.get());
  }
  poses_.emplace(rig_, state_->trajectory);
  for (int index = first; index <= last; ++index) {
    const Observation& observation = state_->observations[static_cast<size_t>(index)];
    if (observation.landmark_id >= 0) {
      Judge(observation);
      Accept(index, true);
    } else if (observation.num_points > 0) {  // has beams left
      candidates_.Offer(
          observation,
          index,
          poses_->Of(observation),
          tracker_->pose_uncertainty().At(state_->trajectory, observation.middle_time_ns()));
    }
  }
  StartPlanes(options_.planes.min_scans);
  candidates_.DropStale(scan.end_ns);
  const int step =
      tracker_->FollowsWell(scan.end_ns) ? options_.window.knot_intervals_per_step : 1;
  if (state_->trajectory.Locate(scan.end_ns).first >= last_solved_interval_ + step) {
    SolveWindow(scan.end_ns);
  }
}

// Takes the recording scan by scan, up to its end or a gap that can not be bridged. Throws
// Error when there is no start or the pose is lost.
void FollowRecording(const Rig& rig,
                     bool planar,
                     const MapperOptions& options,
                     const ProgressCallback& progress,
                     RecordingReader* recording,
                     Follower* follower,
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
        if (now_s > kMaxStartSearch) break;
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

// The planes of the last statement, as they are estimated now.
PlaneCovariance PlanesOf(const std::vector<WindowStatement>& statements,
                         const MapState& state) {
  if (statements.empty()) return {};
  const WindowStatement& last = statements.back();
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
  const bool planar = IsPlanar(rig);
  std::vector<std::string> warnings;
  if (planar) {
    LOG(INFO)
        << "planar rig: all scan planes are horizontal, so height, roll and pitch can not "
           "be seen; estimating the planar motion";
  }
  Stopwatch tracking_watch;
  Stopwatch batch_watch;
  Follower follower(rig, planar, options, recording->scan_period_s());
  {
    const Stopwatch::Running running(&tracking_watch);
    FollowRecording(rig, planar, options, progress, recording, &follower, &warnings);
  }
  PlaneCovariance window_planes = PlanesOf(follower.statements(), follower.state());
  MapResult result(std::move(follower.state()));
  result.window_statements = follower.statements();
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
  constexpr double kDoubtful = 3.0;
  constexpr double kAstray = 25.0;
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

std::vector<PlanePatch> PlanePatches(const MapState& state) {
  std::vector<PlanePatch> patches;
  for (const Landmark& landmark : state.landmarks) {
    if (landmark.num_segments == 0) continue;
    PlanePatch patch;
    patch.id = landmark.id;
    patch.type = landmark.model == PlaneModel::kHorizontal ? PlaneType::kHorizontal
                 : landmark.model == PlaneModel::kVertical ? PlaneType::kVertical
                                                           : PlaneType::kGeneral;
    patch.normal = landmark.Normal();
    patch.distance = landmark.Distance();
    const PatchExtent& extent = landmark.extent;
    const auto on_plane = [&](const Eigen::Vector2d& uv) -> Eigen::Vector3d {
      const Eigen::Vector3d p = extent.ToWorld(uv);
      return p - patch.SignedDistance(p) * patch.normal;
    };
    patch.centre = on_plane(0.5 * (extent.min_corner() + extent.max_corner()));
    for (const Eigen::Vector2d& corner : extent.Outline()) {
      patch.outline.push_back(on_plane(corner));
    }
    const Eigen::Matrix2d by_plane =
        landmark.DeviationJacobian(patch.centre, landmark.extent.u_axis());
    const Eigen::Matrix2d covariance = by_plane * landmark.covariance * by_plane.transpose();
    patch.sigma_distance_m = std::sqrt(covariance(0, 0));
    patch.sigma_angle_rad = std::sqrt(covariance(1, 1));
    patch.num_points = landmark.num_points;
    patch.num_segments = landmark.num_segments;
    patch.first_time_ns = landmark.first_time_ns;
    patch.last_time_ns = landmark.last_time_ns;
    patches.push_back(std::move(patch));
  }
  return patches;
}

}  // namespace plumbline
