#include "core/mapping/batch.h"

#include <glog/logging.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/association/association.h"
#include "core/association/plane_merging.h"
#include "core/estimation/arrowhead_cholesky.h"
#include "core/estimation/arrowhead_equations.h"
#include "core/estimation/estimation_problem.h"
#include "core/estimation/gauss_newton_solver.h"
#include "core/estimation/linearisation.h"
#include "core/estimation/map_covariance.h"
#include "core/estimation/motion_noise_estimation.h"
#include "core/estimation/segment_groups.h"
#include "core/estimation/solver.h"
#include "core/geometry/matrix_types.h"
#include "core/map/landmark_view.h"
#include "core/sensor/rig.h"
#include "core/trajectory/motion_noise.h"
#include "core/util/stopwatch.h"
#include "core/visibility/free_space.h"
#include "core/visibility/resegmentation.h"

namespace plumbline {
namespace {

constexpr double kHuberWidth = 5.0;
// Of the cost, which is half the number of points: what outliers still give way before the
// rounds, they do in them.
constexpr SolverOptions kRoundOptions = {30, 1e-3, 0.0};
// The last estimate ends within a seventh of a standard deviation of the solution, all its
// thousands of unknowns together: half the square of that is the cost.
constexpr SolverOptions kFinalOptions = {30, 0.0, 1e-2};
// Share of the segments that might still change sides in another round before the last
// estimation: what wavers then lies at the limit of its test and weighs next to nothing.
constexpr double kStandingShare = 1e-3;
// Points in short runs over points in segments, at most: for a plane it is below one half, for
// the underside of a door's lintel, which is mostly edges, three halves.
constexpr int64_t kMaxRunsShare = 3;
// A plane's segments deviate by this many times what is expected: furniture's on a real robot
// by two and a half.
constexpr double kContradicted = 3.0;
// Steps to the noise of the motion (ReestimateMotionNoise). A third one moves it by less
// than a hundredth, but where there is no motion at all: that stays too large, which is the
// safe side.
constexpr int kNoiseSteps = 2;
// Of the batch's time, when this is done: for progress, roughly.
constexpr double kFirstEstimateShare = 0.1;
constexpr double kFirstCutShare = 0.4;
constexpr double kLastCutShare = 0.85;
// Groups of two take more memory, of six hardly less; see also kTileControlPoints.
constexpr int kIntervalsPerGroup = 4;

class Batch {
 public:
  Batch(const Rig& rig, bool planar, const MapperOptions& options, MapState* state)
      : rig_(rig),
        planar_(planar),
        options_(options),
        state_(state),
        openings_(state->landmarks.size()),
        motion_noise_(MotionNoise::Of(options.trajectory)) {}

  // See ResegmentRecording; last: the openings are not counted once more.
  int Recut(RecordingReader* recording, bool last) {
    OccupancyGrids counted;
    const int num_resegmented = ResegmentRecording(
        rig_, options_, recording, openings_, last ? nullptr : &counted, state_);
    openings_ = counted.OpeningsOf(state_->landmarks);
    return num_resegmented;
  }

  // The noise of the motion that the last estimation is to assume. The options' own is wide
  // enough for any rig that they are meant for: most are calmer, and their poses are known
  // better.
  void EstimateMotionNoise() {
    for (int i = 0; i < kNoiseSteps; ++i) {
      const auto problem = BuildProblem(FactorKind::kSegment, 0.0);
      const BlockLayout layout = problem->Layout();
      ArrowheadEquations equations = LineariseArrowhead(*problem, layout);
      const ArrowheadCholesky cholesky(std::move(equations.hessian));
      const Eigen::VectorXd step = -cholesky.Solve(equations.gradient);
      problem->Move(layout, step(layout.FreeColumns()));
      motion_noise_ = ReestimateMotionNoise(motion_noise_, *problem, cholesky);
    }
  }

  // All residuals; huber_width 0: plain least squares.
  std::unique_ptr<EstimationProblem> BuildProblem(FactorKind factor, double huber_width) {
    auto problem = std::make_unique<EstimationProblem>(
        rig_, planar_, &state_->trajectory, &state_->landmarks);
    problem->AddTrajectoryTerms(options_.trajectory, motion_noise_, state_->origin_time_ns);
    std::vector<const Observation*> associated;
    std::vector<bool> has_segments(state_->landmarks.size(), false);
    for (const Observation& observation : state_->observations) {
      if (observation.landmark_id < 0) continue;
      has_segments[static_cast<size_t>(observation.landmark_id)] = true;
      if (factor == FactorKind::kPoint) {
        problem->AddPoints(observation);
      } else {
        associated.push_back(&observation);
      }
    }
    // The few beams of sub-minimum segments alone do not determine a plane.
    for (const Observation& run : state_->sub_minimum_segments) {
      if (!has_segments[static_cast<size_t>(run.landmark_id)]) continue;
      if (factor == FactorKind::kPoint) {
        problem->AddPoints(run);
      } else {
        associated.push_back(&run);
      }
    }
    problem->AddSegments(associated, huber_width, &groups_);
    return problem;
  }

  // While associations may still be wrong.
  void EstimateRobustly() {
    const auto problem = BuildProblem(FactorKind::kSegment, kHuberWidth);
    MakeBatchSolver(options_.batch.solver, kRoundOptions)->Solve(problem.get());
  }
  // Between rounds little changes: one step of Gauss-Newton leaves less than the next round's
  // associations will move.
  void StepRobustly() {
    TakeGaussNewtonStep(BuildProblem(FactorKind::kSegment, kHuberWidth).get());
  }

  // Extents, times and counts from the associations as they stand.
  void RebuildLandmarks() {
    RebuildLandmarks(std::vector<bool>(state_->landmarks.size(), true));
  }
  // The same of some, by id.
  void RebuildLandmarks(const std::vector<bool>& which) {
    for (Landmark& landmark : state_->landmarks) {
      if (which[static_cast<size_t>(landmark.id)]) Empty(&landmark);
    }
    SharedPoses poses(rig_, state_->trajectory);
    for (const Observation& observation : state_->observations) {
      const int id = observation.landmark_id;
      if (id < 0 || !which[static_cast<size_t>(id)]) continue;
      CountObservation(observation, poses.Of(observation), state_);
    }
    for (const Observation& run : state_->sub_minimum_segments) {
      Landmark& landmark = state_->landmarks[static_cast<size_t>(run.landmark_id)];
      if (!which[static_cast<size_t>(run.landmark_id)] || landmark.num_segments == 0) continue;
      landmark.num_points += run.num_points;
    }
  }

  // Only the counts: which landmarks still have segments.
  void RecountLandmarks() {
    for (Landmark& landmark : state_->landmarks) landmark.num_segments = 0;
    for (const Observation& observation : state_->observations) {
      if (observation.landmark_id < 0) continue;
      ++state_->landmarks[static_cast<size_t>(observation.landmark_id)].num_segments;
    }
  }

  // Associates every observation anew; returns how many changed.
  int Reassociate() {
    int num_changed = 0;
    SharedPoses poses(rig_, state_->trajectory);
    std::vector<LandmarkView> within_gap;
    std::vector<LandmarkView> candidates;
    int scan_index = -1;
    for (size_t i = 0; i < state_->observations.size(); ++i) {
      Observation& observation = state_->observations[i];
      if (observation.scan_index != scan_index) {
        if (scan_index < 0 || !options_.loop_closure.enabled) {
          within_gap =
              ViewsWithinGap(state_->landmarks, observation.scan_index, options_.loop_closure);
        }
        scan_index = observation.scan_index;
        candidates = ViewsWithin(ReachOfScan(rig_,
                                             state_->observations,
                                             i,
                                             poses.Of(observation).world_from_body.translation,
                                             Matrix6d::Zero(),
                                             options_.association),
                                 within_gap);
      }
      if (observation.num_points == 0) continue;  // all of its beams are left out
      int id = FindLandmark(observation,
                            poses.Of(observation),
                            Matrix6d::Zero(),
                            candidates,
                            options_.association);
      if (id >= 0 && id == observation.landmark_id && IsAlone(observation, &poses)) id = -1;
      num_changed += id != observation.landmark_id ? 1 : 0;
      observation.landmark_id = id;
    }
    return num_changed;
  }

  // Whether nothing else has been seen of its plane where the observation lies: what the
  // plane's first, uncertain estimate took in far away from it would hold it there for good.
  bool IsAlone(const Observation& observation, SharedPoses* poses) const {
    const Landmark& landmark = state_->landmarks[static_cast<size_t>(observation.landmark_id)];
    const ScanMotion& motion = poses->Of(observation).motion;
    return !landmark.extent.OthersAreNear(
        motion.ToWorld(observation.start(), observation.start_time_ns()),
        motion.ToWorld(observation.end(), observation.end_time_ns()),
        options_.association.max_gap_m);
  }

  // The landmarks that others were merged into, one entry for each of these.
  std::vector<int> MergeDuplicates() {
    std::vector<int> merged_into;
    const auto pairs = FindMergeablePlanes(rig_, *state_, options_, 0);
    // A landmark that was itself merged away passes its share on.
    std::vector<int> target(state_->landmarks.size());
    for (size_t i = 0; i < target.size(); ++i) target[i] = static_cast<int>(i);
    for (const auto& [into, from] : pairs) {
      const int end = target[static_cast<size_t>(into)];
      target[static_cast<size_t>(from)] = end;
      MergeInto(end, from, state_);
      merged_into.push_back(end);
    }
    return merged_into;
  }

  // Takes the observations from landmarks that only repeat a stronger one (IsRedundant).
  int DropShadows() {
    const double range_noise_m = MaxRangeNoise(rig_);
    std::vector<bool> is_redundant(state_->landmarks.size(), false);
    for (const Landmark& weak : state_->landmarks) {
      for (const Landmark& strong : state_->landmarks) {
        if (weak.num_points == 0 || weak.num_points >= strong.num_points) continue;
        if (!IsWithinGap(strong, weak.first_scan, options_.loop_closure)) continue;
        if (!IsRedundant(weak, strong, range_noise_m)) continue;
        is_redundant[static_cast<size_t>(weak.id)] = true;
        break;
      }
    }
    return Release(is_redundant);
  }

  // Takes the observations from landmarks that other beams pass through.
  int DropPassedThrough() { return Release(FindPassedThrough(rig_, *state_)); }

  // Landmarks that their own segments contradicted on the way: slants across corners. Where
  // noise is more than stated, all planes' segments deviate.
  int DropContradicted() {
    double sum = 0.0;
    int num_judged = 0;
    for (const Landmark& landmark : state_->landmarks) {
      sum += landmark.sum_deviations;
      num_judged += landmark.num_judged;
    }
    const double expected = std::max(2.0, sum / std::max(1, num_judged));
    std::vector<bool> is_contradicted;
    for (const Landmark& landmark : state_->landmarks) {
      is_contradicted.push_back(!landmark.AgreesWithin(kContradicted * expected));
    }
    return Release(is_contradicted);
  }

  // Landmarks that fewer scans support than a new plane needs.
  int DropWeak() {
    std::vector<int> num_scans(state_->landmarks.size(), 0);
    std::vector<int> last_scan(state_->landmarks.size(), -1);
    for (const Observation& observation : state_->observations) {  // by time
      if (observation.landmark_id < 0) continue;
      const auto id = static_cast<size_t>(observation.landmark_id);
      if (observation.scan_index != last_scan[id]) ++num_scans[id];
      last_scan[id] = observation.scan_index;
    }
    std::vector<bool> is_weak;
    for (const int num : num_scans) is_weak.push_back(num < options_.planes.min_scans);
    return Release(is_weak);
  }

  // Planes that segments hardly know: what almost only short runs lie on is a slant across a
  // corner. Takes the observations from them, and drops their runs.
  int DropSlants() {
    std::vector<int64_t> in_segments(state_->landmarks.size(), 0);
    std::vector<int64_t> in_runs(state_->landmarks.size(), 0);
    for (const Observation& observation : state_->observations) {
      if (observation.landmark_id < 0) continue;
      in_segments[static_cast<size_t>(observation.landmark_id)] += observation.num_points;
    }
    for (const Observation& run : state_->sub_minimum_segments) {
      in_runs[static_cast<size_t>(run.landmark_id)] += run.num_points;
    }
    std::vector<bool> is_slant;
    for (size_t i = 0; i < in_runs.size(); ++i) {
      is_slant.push_back(in_runs[i] > kMaxRunsShare * in_segments[i]);
    }
    const int num_released = Release(is_slant);
    std::deque<Observation>& runs = state_->sub_minimum_segments;
    runs.erase(std::remove_if(runs.begin(),
                              runs.end(),
                              [&](const Observation& run) {
                                return is_slant[static_cast<size_t>(run.landmark_id)];
                              }),
               runs.end());
    return num_released;
  }

  // Of the estimate that these equations are of.
  MapCovariance SetCovariances(const EstimationProblem& problem,
                               ArrowheadEquations equations) {
    MapCovariance covariance = MapCovariance::Of(problem, std::move(equations));
    const std::vector<int>& offsets = covariance.offsets();
    for (size_t i = 0; i < covariance.landmark_ids().size(); ++i) {
      const int size = offsets[i + 1] - offsets[i];
      Landmark& landmark =
          state_->landmarks[static_cast<size_t>(covariance.landmark_ids()[i])];
      landmark.covariance.setZero();
      landmark.covariance.topLeftCorner(size, size) =
          covariance.landmarks().block(offsets[i], offsets[i], size, size);
    }
    return covariance;
  }

  // Plain least squares, with its covariance.
  void EstimateFinally(BatchReport* report) {
    EstimateMotionNoise();
    report->motion_noise = motion_noise_;
    groups_.set_validity(LinearisedGroup::kFine);
    const FactorKind factor = options_.batch.factor;
    const auto problem = BuildProblem(factor, 0.0);
    ArrowheadEquations equations =
        MakeBatchSolver(options_.batch.solver, kFinalOptions)->Solve(problem.get());
    report->variance_factor = VarianceFactor(problem->Layout(), equations.cost, factor);
    const Stopwatch::Running running(&report->covariance_watch);
    report->covariance = SetCovariances(*problem, std::move(equations));
  }

 private:
  double VarianceFactor(const BlockLayout& layout, double cost, FactorKind factor) const {
    double num_points = 0.0;
    double constant = 0.0;
    SharedPoses poses(rig_, state_->trajectory);
    const auto add = [&](const Observation& observation) {
      if (observation.landmark_id < 0) return;
      num_points += observation.num_points;
      if (factor == FactorKind::kPoint) return;  // its residuals hold everything
      const double offset =
          ObservationWeights(poses.Of(observation), state_->landmarks, observation).offset;
      constant += offset * offset * observation.measurement.constant();
    };
    for (const Observation& observation : state_->observations) add(observation);
    for (const Observation& run : state_->sub_minimum_segments) add(run);
    const auto num_unknowns = static_cast<double>(layout.FreeColumns().size());
    return (2.0 * cost + constant) / (num_points - num_unknowns);
  }

  // Leaves the observations of these landmarks without one; returns how many.
  int Release(const std::vector<bool>& landmarks) {
    int num_released = 0;
    for (Observation& observation : state_->observations) {
      if (observation.landmark_id < 0) continue;
      const auto id = static_cast<size_t>(observation.landmark_id);
      // The gauge's wall stays: without it the heading is nobody's.
      if (!landmarks[id] || state_->landmarks[id].heading_fixed) continue;
      observation.landmark_id = -1;
      ++num_released;
    }
    for (Landmark& landmark : state_->landmarks) {
      const bool is_released = landmarks[static_cast<size_t>(landmark.id)];
      if (is_released && !landmark.heading_fixed) Empty(&landmark);
    }
    return num_released;
  }

  // Leaves a landmark as it is before its first observation is counted.
  static void Empty(Landmark* landmark) {
    landmark->extent = landmark->EmptyExtent();
    landmark->num_segments = 0;
    landmark->num_points = 0;
    landmark->last_scan = 0;
    landmark->last_time_ns = 0;
  }

  const Rig& rig_;
  bool planar_;
  const MapperOptions& options_;
  MapState* state_;
  std::vector<PlaneOpenings> openings_;  // of the landmarks, by id
  MotionNoise motion_noise_;
  SegmentGroupCache groups_{LinearisedGroup::kCoarse, kIntervalsPerGroup};
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
  Batch batch(rig, planar, options, state);
  BatchReport report;
  const int num_contradicted = batch.DropContradicted();
  VLOG(1) << num_contradicted << " segments taken from planes that contradict them";
  // A robust estimate first: associations made on the way may be wrong.
  batch.EstimateRobustly();
  double share_done = kFirstEstimateShare;
  int last_changes = 0;
  for (int round = 1; round <= options.batch.max_rounds; ++round) {
    report.rounds = round;
    batch.RebuildLandmarks();
    const std::vector<int> merged_into = batch.MergeDuplicates();
    int num_dropped = batch.DropShadows() + batch.DropPassedThrough();
    if (!merged_into.empty()) {
      std::vector<bool> which(state->landmarks.size(), false);
      for (const int id : merged_into) which[static_cast<size_t>(id)] = true;
      batch.RebuildLandmarks(which);
    }
    const int num_changed = batch.Reassociate();
    num_dropped += batch.DropWeak();
    report.changed_associations = num_changed + num_dropped;
    LOG(INFO) << "batch round " << round << ": " << num_changed << " associations changed, "
              << merged_into.size() << " planes merged, " << num_dropped
              << " segments taken from planes that are none";
    progress(share_done);
    const double next = ChangesToCome(report.changed_associations, last_changes);
    last_changes = report.changed_associations;
    // Openings are known from the second reading of the recording on.
    const bool may_stand = round > 1 || !options.batch.resegment;
    const bool stands =
        may_stand && next < kStandingShare * static_cast<double>(state->observations.size());
    const bool last = stands || round == options.batch.max_rounds;
    if (options.batch.resegment && (round == 1 || last)) {
      batch.RecountLandmarks();
      const int num_resegmented = batch.Recut(recording, last);
      const int num_slants = batch.DropSlants();
      VLOG(1) << "ends of " << num_resegmented << " segments moved, " << num_slants
              << " segments taken from slants";
      share_done = last ? kLastCutShare : kFirstCutShare;
      progress(share_done);
    }
    if (!last) {
      batch.StepRobustly();
      continue;
    }
    batch.EstimateFinally(&report);
    break;
  }
  batch.RebuildLandmarks();
  return report;
}

}  // namespace plumbline
