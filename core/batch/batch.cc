#include "core/batch/batch.h"

#include <glog/logging.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/batch/batch_policies.h"
#include "core/batch/drift_correction.h"
#include "core/batch/level_splitting.h"
#include "core/batch/loop_closures.h"
#include "core/visibility/occupancy_grids.h"
#include "core/visibility/resegmentation.h"

namespace plumbline {
namespace {

// Share of the segments that might still change sides in another round before the last
// estimation: what wavers then lies at the limit of its test and weighs next to nothing.
constexpr double kSettledShare = 1e-3;
// Shares of the batch's time after which a stage is done, roughly: for progress.
constexpr double kFirstEstimateShare = 0.1;
constexpr double kFirstResegmentationShare = 0.4;
constexpr double kLastResegmentationShare = 0.85;

// One run of the batch.
class Batch {
 public:
  Batch(const Rig& rig,
        bool planar,
        const MapperOptions& options,
        const ProgressCallback& progress,
        RecordingReader* recording,
        MapState* state)
      : rig_(rig),
        planar_(planar),
        options_(options),
        progress_(progress),
        recording_(recording),
        state_(state),
        estimator_(planar, options, state, &rig_),
        openings_(state->landmarks.size()) {}

  // Rounds of better associations and a better estimate, then the last estimation.
  BatchReport Run() {
    const int num_contradicted = DropContradictedPlanes(state_) +
                                 DropPlanesWithoutLines(state_) +
                                 DecideGeneralPlanes(rig_, options_.association, state_);
    VLOG(1) << num_contradicted << " segments taken from planes that contradict them";
    estimator_.EstimateRobustly();  // associations made on the way may be wrong
    RecogniseRevisits();
    share_done_ = kFirstEstimateShare;
    int round = 0;
    int num_changed = 0;
    for (bool is_last = false; !is_last;) {
      ++round;
      const int num_changed_before = num_changed;
      num_changed = ImproveAssociations(round);
      is_last = IsLast(round, ChangesToCome(num_changed, num_changed_before));
      if (options_.batch.resegment && (round == 1 || is_last)) Resegment(is_last);
      if (!is_last) estimator_.StepRobustly();
    }
    BatchReport report{estimator_.EstimateFinally(), round, num_changed};
    while (DropVanishedCylinders(state_) > 0) {
      KeepHeadingHeld(state_);
      static_cast<FinalEstimate&>(report) = estimator_.EstimateFinally();
    }
    RebuildLandmarks(rig_, state_);
    report.closures = Closures();
    report.drift_m = drift_m_;
    return report;
  }

 private:
  void RecogniseRevisits() {
    if (!planar_ || !options_.loop_closure.enabled) return;
    // The search for places needs memory, too, and where drift is corrected, all is linearised
    // anew.
    estimator_.ForgetLinearisations();
    drift_m_ = CorrectDrift(rig_, recording_, state_);
    if (!drift_m_) return;
    DropWeakPlanes(options_.planes, state_);
    KeepHeadingHeld(state_);
    openings_.resize(state_->landmarks.size());
    estimator_.EstimateRobustly();
  }

  // Applies the rules to the landmarks and segments as they are estimated now; returns how
  // many associations changed.
  int ImproveAssociations(int round) {
    TakeBackClosures();
    RebuildLandmarks(rig_, state_);
    const std::vector<int> merged_into = MergePlanes(rig_, options_, apart_, state_);
    const RuleOptions& rules = options_.rules;
    int num_dropped = 0;
    if (rules.redundant_planes) {
      num_dropped += DropRedundantPlanes(rig_, options_, apart_, state_);
    }
    if (rules.passed_through_planes) num_dropped += DropPassedThrough(rig_, state_);
    std::vector<bool> is_merged(state_->landmarks.size(), false);
    for (const int id : merged_into) is_merged[static_cast<size_t>(id)] = true;
    if (!merged_into.empty()) RebuildLandmarks(rig_, is_merged, state_);
    int num_bent = 0;
    if (rules.bent_walls) num_bent += BendWalls(rig_, options_.association, state_);
    if (rules.rows_of_chords) num_bent += BendRowsOfChords(rig_, options_.association, state_);
    if (num_dropped + num_bent > 0) {
      // What was no surface held the poses, too: associations go by where these are without
      // it.
      RebuildLandmarks(rig_, state_);
      KeepHeadingHeld(state_);
      estimator_.StepRobustly();
    }
    poses_ = estimator_.PosesOnSurfaces();
    const int num_changed = Reassociate(rig_, options_, PoseCovariances(), state_) + num_bent;
    num_dropped += DropWeakPlanes(options_.planes, state_) +
                   DecideGeneralPlanes(rig_, options_.association, state_);
    KeepHeadingHeld(state_);
    LOG(INFO) << "batch round " << round << ": " << num_changed << " associations changed, "
              << merged_into.size() << " planes merged, " << num_dropped
              << " segments taken from planes that are none";
    progress_(share_done_);
    return num_changed + num_dropped;
  }

  // The poses' covariances where surfaces are as they were when associations were last
  // improved.
  PoseCovarianceAt PoseCovariances() const {
    return [this](int64_t time_ns) { return poses_->PoseAt(state_->trajectory, time_ns); };
  }

  // Estimates anew where closures are taken back: what they had bent straightens.
  void TakeBackClosures() {
    const int num_changed =
        TakeBackContradictedClosures(rig_, options_, state_, &rejected_closures_);
    if (num_changed == 0) return;
    LOG(INFO) << num_changed << " segments taken from closures that their visits contradict";
    for (const LoopClosure& closure : rejected_closures_) {
      apart_.insert({closure.surface_a, closure.surface_b});
    }
    openings_.resize(state_->landmarks.size());
    RebuildLandmarks(rig_, state_);
    estimator_.EstimateRobustly();
  }

  // The closures of the finished map, and those taken back.
  std::vector<LoopClosure> Closures() const {
    std::vector<LoopClosure> closures = TestLoopClosures(rig_, options_, *state_);
    closures.insert(closures.end(), rejected_closures_.begin(), rejected_closures_.end());
    std::stable_sort(
        closures.begin(), closures.end(), [](const LoopClosure& a, const LoopClosure& b) {
          return a.time_ns < b.time_ns;
        });
    return closures;
  }

  // Whether the last estimation follows this round, after which another one would change so
  // many associations.
  bool IsLast(int round, double num_changes_to_come) const {
    if (round == options_.batch.max_rounds) return true;
    // Openings are known from the second reading of the recording on.
    if (round == 1 && options_.batch.resegment) return false;
    return num_changes_to_come <
           kSettledShare * static_cast<double>(state_->observations.size());
  }

  // Cuts the segments anew where the planes intersect. The last time, the openings of the
  // planes are not counted once more.
  void Resegment(bool is_last) {
    RecountSegments(state_);
    OccupancyGrids counted;
    const int num_resegmented = ResegmentRecording(rig_,
                                                   options_,
                                                   recording_,
                                                   PoseCovariances(),
                                                   openings_,
                                                   is_last ? nullptr : &counted,
                                                   state_);
    poses_.reset();
    std::vector<LevelOnSurface> levels;
    openings_ = counted.OpeningsOf(
        state_->landmarks, options_.association.surface_flatness_m, &levels);
    const std::set<std::pair<int, int>> split =
        SplitLevels(rig_, options_.association, levels, &openings_, state_);
    apart_.insert(split.begin(), split.end());
    VLOG(1) << split.size() << " levels taken from the surfaces that held them";
    const int num_oblique = options_.rules.oblique_planes ? DropObliqueFalsePlanes(state_) : 0;
    const int num_dropped = num_oblique + DropWeakPlanes(options_.planes, state_) +
                            DecideGeneralPlanes(rig_, options_.association, state_);
    VLOG(1) << "ends of " << num_resegmented << " segments moved, " << num_dropped
            << " segments taken from planes that this leaves too little";
    share_done_ = is_last ? kLastResegmentationShare : kFirstResegmentationShare;
    progress_(share_done_);
  }

  Rig rig_;  // its poses as they are estimated
  bool planar_;
  const MapperOptions& options_;
  const ProgressCallback& progress_;
  RecordingReader* recording_;
  MapState* state_;
  BatchEstimator estimator_;
  std::optional<MapCovariance> poses_;   // surfaces held
  std::vector<PlaneOpenings> openings_;  // of the landmarks, by id
  std::vector<LoopClosure> rejected_closures_;
  std::set<std::pair<int, int>> apart_;  // landmarks of rejected closures, and levels
  std::optional<double> drift_m_;
  double share_done_ = 0.0;  // of the batch's time
};

}  // namespace

double ChangesToCome(int now, int before) {
  return now < before ? static_cast<double>(now) * now / before : now;
}

BatchReport EstimateBatch(const Rig& rig,
                          bool planar,
                          const MapperOptions& options,
                          const ProgressCallback& progress,
                          RecordingReader* recording,
                          MapState* state) {
  return Batch(rig, planar, options, progress, recording, state).Run();
}

}  // namespace plumbline
