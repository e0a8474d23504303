#include "core/batch/batch_estimator.h"

#include <ceres/cost_function.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/estimation/arrowhead_cholesky.h"
#include "core/estimation/arrowhead_equations.h"
#include "core/estimation/error_patterns.h"
#include "core/estimation/gauss_newton_solver.h"
#include "core/estimation/imu_terms.h"
#include "core/estimation/linearisation.h"
#include "core/estimation/motion_noise_estimation.h"
#include "core/estimation/odometry_terms.h"
#include "core/estimation/pose_prior.h"
#include "core/estimation/solver.h"
#include "core/map/observation_poses.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// A share of the cost, which is half the number of points: what outliers still give way before
// the rounds, they do in them.
constexpr SolverOptions kRoundOptions = {30, 1e-3, 0.0};
// The last estimate ends within a seventh of a standard deviation of the solution, all its
// thousands of unknowns together: half the square of that is the cost.
constexpr SolverOptions kFinalOptions = {30, 0.0, 1e-2};
// The noise of the motion is estimated in steps until it changes by less than this share: its
// square root has a standard error of a few per cent.
constexpr double kNoiseTolerance = 0.03;
constexpr int kMaxNoiseSteps = 3;
// Of the scans that show whether there are correlated errors, s.
constexpr double kSamplingInterval = 0.2;

// Calls visit(observation) for the observations with a landmark and for the sub-minimum
// segments of these landmarks: the few beams of such segments alone do not determine a plane.
template <typename Visit>
void ForEachAssociated(const MapState& state, const Visit& visit) {
  std::vector<bool> has_segments(state.landmarks.size(), false);
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id < 0) continue;
    has_segments[static_cast<size_t>(observation.landmark_id)] = true;
    visit(observation);
  }
  for (const Observation& segment : state.sub_minimum_segments) {
    if (has_segments[static_cast<size_t>(segment.landmark_id)]) visit(segment);
  }
}

// Returns the step from scan to scan of a sample that shows errors that repeat as well as all
// scans do.
int SamplingOf(const MapState& state) {
  if (state.observations.empty()) return 1;
  const Observation& first = state.observations.front();
  const Observation& last = state.observations.back();
  const auto scans = static_cast<double>(last.scan_index - first.scan_index);
  const double span_s = SecondsBetween(first.start_time_ns(), last.start_time_ns());
  return std::max(1, static_cast<int>(scans * kSamplingInterval / std::max(span_s, 1.0)));
}

// Ceres' Jacobian of an hour takes 6 GB and more, several times as much as all else.
SolverKind SolverOf(const MapState& state, const BatchOptions& options) {
  constexpr int kMaxControlPoints = 12000;  // ten minutes of the default knots
  const bool is_long = state.trajectory.num_control_points() > kMaxControlPoints;
  LOG_IF(INFO, is_long && options.solver == SolverKind::kCeres)
      << "the final estimation of so long a recording is by Gauss-Newton of our own";
  return is_long ? SolverKind::kGaussNewton : options.solver;
}

}  // namespace

BatchEstimator::BatchEstimator(bool planar,
                               const MapperOptions& options,
                               MapState* state,
                               Rig* rig)
    : rig_(rig),
      planar_(planar),
      options_(options),
      state_(state),
      motion_noise_(
          MotionProfile::Uniform(MotionNoise::Of(options.trajectory), state->trajectory)),
      groups_(LinearisedGroup::kCoarse, kIntervalsPerGroup) {}

void BatchEstimator::EstimateRobustly() {
  EstimateWithNoise(options_.association.huber_width, kRoundOptions);
}

void BatchEstimator::ForgetLinearisations() {
  groups_.ForgetBefore(std::numeric_limits<int>::max());
}

void BatchEstimator::StepRobustly() {
  TakeGaussNewtonStep(
      BuildProblem(FactorKind::kSegment, options_.association.huber_width).get());
  state_->calibration.ApplyTo(rig_);
}

MapCovariance BatchEstimator::PosesOnSurfaces() {
  return MapCovariance::OfPoses(
      *BuildProblem(FactorKind::kSegment, options_.association.huber_width));
}

FinalEstimate BatchEstimator::EstimateFinally() {
  groups_.set_validity(LinearisedGroup::kFine);
  for (int step = 0; step < kMaxNoiseSteps; ++step) {
    if (EstimateWithNoise(0.0, kFinalOptions) < kNoiseTolerance) break;
  }
  FinalEstimate estimate;
  const auto problem = BuildProblem(options_.batch.factor, 0.0);
  ArrowheadEquations equations =
      MakeBatchSolver(SolverOf(*state_, options_.batch), kFinalOptions)->Solve(problem.get());
  state_->calibration.ApplyTo(rig_);
  VLOG(1) << "cost " << equations.cost;
  const std::vector<MotionEvidence> evidence = FindMotionEvidence(
      motion_noise_,
      *problem,
      ArrowheadCholesky(std::move(equations.hessian), BorderElimination::kNested));
  estimate.motion_noise = motion_noise_.usual;
  estimate.variance_factor = VarianceFactor(*problem, equations.cost, SumOf(evidence));
  const Stopwatch::Running running(&estimate.covariance_watch);
  estimate.covariance = SetCovariances(*problem);
  return estimate;
}

double BatchEstimator::EstimateWithNoise(double huber_width, const SolverOptions& options) {
  const auto problem = BuildProblem(FactorKind::kSegment, huber_width);
  ArrowheadEquations equations =
      GaussNewtonSolver<ArrowheadEquations>(options).Solve(problem.get());
  state_->calibration.ApplyTo(rig_);
  return TakeNoise(FindMotionEvidence(
      motion_noise_,
      *problem,
      ArrowheadCholesky(std::move(equations.hessian), BorderElimination::kNested)));
}

double BatchEstimator::TakeNoise(const std::vector<MotionEvidence>& evidence) {
  if (!options_.trajectory.estimate_densities) return 0.0;
  const MotionNoise before = motion_noise_.usual;
  motion_noise_ = MotionProfile::From(evidence, before, state_->trajectory.knot_interval_s());
  double change = 0.0;
  for (size_t kind = 0; kind < kNumMotionKinds; ++kind) {
    change = std::max(
        change, std::abs(motion_noise_.usual.density[kind] / before.density[kind] - 1.0));
  }
  return change;
}

std::unique_ptr<EstimationProblem> BatchEstimator::BuildProblem(FactorKind factor,
                                                                double huber_width) {
  auto problem = std::make_unique<EstimationProblem>(
      *rig_,
      planar_,
      &state_->trajectory,
      &state_->landmarks,
      factor == FactorKind::kSegment ? &state_->calibration : nullptr);
  if (factor == FactorKind::kSegment) AddScannerPriors(state_->calibration, problem.get());
  if (static_cast<int>(motion_noise_.at.size()) + 2 !=
      state_->trajectory.num_control_points()) {
    motion_noise_ = MotionProfile::Uniform(motion_noise_.usual, state_->trajectory);
  }
  motion_noise_.FollowHeight(state_->trajectory);
  problem->AddTrajectoryTerms(options_.trajectory, motion_noise_, state_->origin_time_ns);
  if (state_->odometry != nullptr) {
    const int num_intervals = state_->trajectory.num_control_points() - kSplineOrder + 1;
    state_->odometry_calibration = OdometryCalibration(options_.odometry);
    Calibrate(*state_, 0, num_intervals, &state_->odometry_calibration);
    AddOdometry(*state_, 0, num_intervals, problem.get());
  }
  if (state_->imu != nullptr && factor == FactorKind::kSegment) {
    const int num_intervals = state_->trajectory.num_control_points() - kSplineOrder + 1;
    state_->calibration.imu->ExtendTo(num_intervals);
    AddImuPrior(*state_->calibration.imu, problem.get());
    AddImu(*state_, 0, num_intervals, 1, problem.get());
  }
  std::vector<const Observation*> associated;
  ForEachAssociated(*state_, [&](const Observation& observation) {
    if (factor == FactorKind::kPoint) {
      problem->AddPoints(observation);
    } else {
      associated.push_back(&observation);
    }
  });
  problem->AddSegments(associated, huber_width, &groups_);
  return problem;
}

double BatchEstimator::VarianceFactor(const EstimationProblem& problem,
                                      double cost,
                                      const MotionEvidence& motion) const {
  double num_points = 0.0;
  double constant = 0.0;
  SharedPoses poses(*rig_, state_->trajectory);
  ForEachAssociated(*state_, [&](const Observation& observation) {
    num_points += observation.num_points;
    if (options_.batch.factor == FactorKind::kPoint) return;  // its residuals hold everything
    const double offset =
        ObservationWeights(poses.Of(observation), state_->landmarks, observation).offset;
    const PackedSegment& segment = observation.measurement;
    // Where ranges are estimated, the cost has their part of it.
    const double in_cost = state_->calibration.IsEstimated(observation.scanner_index)
                               ? segment.range_offset()
                               : 0.0;
    constant += offset * offset * (segment.constant() - in_cost * in_cost);
  });
  for (const FactorTerm& term : problem.factor_terms()) {
    if (term.kind == FactorTerm::Kind::kImu) num_points += term.factor->num_residuals();
  }
  const auto num_unknowns = static_cast<double>(problem.Layout().FreeColumns().size());
  return (2.0 * (cost - motion.prior_cost) + constant) /
         (num_points - num_unknowns + motion.by_prior);
}

CorrelatedErrors BatchEstimator::FindCorrelatedErrors(const EstimationProblem& problem,
                                                      const ArrowheadCholesky& factor) const {
  const BlockLayout layout = problem.Layout();
  const auto for_each = [&](int step, const auto& visit) {
    ForEachAssociated(*state_, [&](const Observation& observation) {
      if (observation.scan_index % step == 0) visit(observation);
    });
  };
  const auto make = [&](const auto&... with_factor) {
    return ErrorPatterns(*rig_,
                         state_->calibration,
                         state_->trajectory,
                         state_->landmarks,
                         layout,
                         planar_,
                         with_factor...);
  };
  // Most of the time goes into recordings that show such errors.
  const auto find_deviations = [&] {
    const int step = SamplingOf(*state_);
    ErrorPatterns sampled = make();
    for_each(step, [&](const Observation& observation) { sampled.Add(observation); });
    return EstimateDeviations(
        factor, [&](const auto& visit) { for_each(step, visit); }, &sampled);
  };
  std::optional<std::vector<double>> deviations = find_deviations();
  if (!deviations) return {};
  ErrorPatterns patterns = make(factor);
  patterns.SetDeviations(std::move(*deviations));
  for_each(1, [&](const Observation& observation) { patterns.Add(observation); });
  const CorrelatedErrors errors = EstimateCorrelatedErrors(
      factor, [&](const auto& visit) { for_each(1, visit); }, &patterns);
  LOG(INFO) << "errors that repeat: unevenness " << 1e3 * errors.unevenness_m
            << " mm, range bias " << 1e3 * errors.range_bias_m << " mm, mounting "
            << errors.rotation_rad * 180.0 / M_PI << " deg, " << 1e3 * errors.translation_m
            << " mm";
  return errors;
}

MapCovariance BatchEstimator::SetCovariances(const EstimationProblem& problem) {
  ArrowheadEquations equations = LineariseArrowhead(problem, problem.Layout());
  MapCovariance covariance =
      options_.batch.correlated_errors == CorrelatedErrorsKind::kOff
          ? MapCovariance::Of(problem, std::move(equations))
          : MapCovariance::Of(
                problem, std::move(equations), [&](const ArrowheadCholesky& factor) {
                  return FindCorrelatedErrors(problem, factor);
                });
  const std::vector<int>& offsets = covariance.offsets();
  for (size_t i = 0; i < covariance.landmark_ids().size(); ++i) {
    const int size = offsets[i + 1] - offsets[i];
    Landmark& landmark = state_->landmarks[static_cast<size_t>(covariance.landmark_ids()[i])];
    landmark.covariance.setZero();
    landmark.covariance.topLeftCorner(size, size) =
        covariance.landmarks().block(offsets[i], offsets[i], size, size);
  }
  SetCalibrationCovariance(problem, covariance, &state_->calibration);
  return covariance;
}

}  // namespace plumbline
