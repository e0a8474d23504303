#include "core/mapping/batch_estimator.h"

#include <glog/logging.h>

#include <optional>
#include <utility>
#include <vector>

#include "core/estimation/arrowhead_cholesky.h"
#include "core/estimation/arrowhead_equations.h"
#include "core/estimation/motion_noise_estimation.h"
#include "core/map/observation_poses.h"

namespace plumbline {
namespace {

// In standard deviations of the norm of a segment's residuals: good segments hardly ever
// exceed it.
constexpr double kHuberWidth = 5.0;
// A share of the cost, which is half the number of points: what outliers still give way before
// the rounds, they do in them.
constexpr EstimationProblem::Tolerance kRoundTolerance = {1e-3, 0.0};
// The last estimate ends within a seventh of a standard deviation of the solution, all its
// thousands of unknowns together: half the square of that is the cost.
constexpr EstimationProblem::Tolerance kFinalTolerance = {0.0, 1e-2};
constexpr double kCeresTolerance = 1e-9;  // of the cost
constexpr int kMaxIterations = 30;
// Steps to the noise of the motion (ReestimateMotionNoise). The third moves it by less
// than a hundredth, but where there is no motion at all: that stays too large, which is the
// safe side.
constexpr int kNoiseSteps = 3;
// Groups of two take more memory, of six hardly less; see also kTileControlPoints.
constexpr int kIntervalsPerGroup = 4;

// Calls visit(observation) for the observations with a landmark and for the sub-minimum
// segments.
template <typename Visit>
void ForEachAssociated(const MapState& state, const Visit& visit) {
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id >= 0) visit(observation);
  }
  for (const Observation& segment : state.sub_minimum_segments) visit(segment);
}

}  // namespace

BatchEstimator::BatchEstimator(const Rig& rig,
                               bool planar,
                               const MapperOptions& options,
                               MapState* state)
    : rig_(rig),
      planar_(planar),
      options_(options),
      state_(state),
      motion_noise_(MotionNoise::Of(options.trajectory)),
      groups_(LinearisedGroup::kCoarse, kIntervalsPerGroup) {}

void BatchEstimator::EstimateRobustly() {
  BuildProblem(FactorKind::kSegment, kHuberWidth)
      ->SolveArrowhead(kMaxIterations, kRoundTolerance);
}

void BatchEstimator::StepRobustly() {
  BuildProblem(FactorKind::kSegment, kHuberWidth)->TakeArrowheadStep();
}

void BatchEstimator::EstimateMotionNoise() {
  for (int step = 0; step < kNoiseSteps; ++step) {
    const auto problem = BuildProblem(FactorKind::kSegment, 0.0);
    EstimationProblem::Solution solution = problem->SolveArrowhead(1, kRoundTolerance);
    motion_noise_ = ReestimateMotionNoise(
        motion_noise_, *problem, ArrowheadCholesky(std::move(solution.equations.hessian)));
  }
}

FinalEstimate BatchEstimator::EstimateFinally() {
  groups_.set_validity(LinearisedGroup::kFine);
  const FactorKind factor = options_.batch.factor;
  const auto problem = BuildProblem(factor, 0.0);
  std::optional<MotionNoise> found;  // before the first step: little changes after it
  EstimationProblem::Solution solution =
      Solve(factor, problem.get(), [&](const ArrowheadCholesky& at) {
        if (!found) found = ReestimateMotionNoise(motion_noise_, *problem, at);
      });
  VLOG(1) << "cost " << solution.equations.cost << ", " << solution.num_unknowns
          << " unknowns";
  FinalEstimate estimate;
  estimate.motion_noise = motion_noise_;
  estimate.motion_found = found.value_or(motion_noise_);
  estimate.variance_factor = VarianceFactor(solution, factor);
  {
    const Stopwatch::Running running(&estimate.covariance_watch);
    estimate.covariance =
        SetCovariances(*problem, estimate.motion_found, std::move(solution.equations));
  }
  return estimate;
}

std::unique_ptr<EstimationProblem> BatchEstimator::BuildProblem(FactorKind factor,
                                                                double huber_width) {
  auto problem = std::make_unique<EstimationProblem>(
      rig_, planar_, &state_->trajectory, &state_->landmarks);
  problem->AddTrajectoryTerms(options_.trajectory, motion_noise_, state_->origin_time_ns);
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

EstimationProblem::Solution BatchEstimator::Solve(
    FactorKind factor,
    EstimationProblem* problem,
    const EstimationProblem::CholeskyVisitor& visit) const {
  if (factor == FactorKind::kSegment) {
    return problem->SolveArrowhead(kMaxIterations, kFinalTolerance, visit);
  }
  ceres::Solver::Options options;
  // SPARSE_SCHUR with the planes eliminated first is 30 times slower: they see everything.
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = kMaxIterations;
  options.function_tolerance = kCeresTolerance;
  options.initial_trust_region_radius = 1e12;
  options.num_threads = 1;  // Ceres sums costs by thread: more would change the result
  options.logging_type = ceres::SILENT;
  const ceres::Solver::Summary summary = problem->Solve(options);
  EstimationProblem::Solution solution{problem->LineariseArrowhead(problem->Layout()),
                                       summary.num_effective_parameters_reduced};
  visit(ArrowheadCholesky(solution.equations.hessian));
  return solution;
}

double BatchEstimator::VarianceFactor(const EstimationProblem::Solution& solution,
                                      FactorKind factor) const {
  double num_points = 0.0;
  double constant = 0.0;
  SharedPoses poses(rig_, state_->trajectory);
  ForEachAssociated(*state_, [&](const Observation& observation) {
    num_points += observation.num_points;
    if (factor == FactorKind::kPoint) return;  // its residuals hold everything
    const double offset =
        ObservationWeights(poses.Of(observation), state_->landmarks, observation).offset;
    constant += offset * offset * observation.measurement.constant();
  });
  return (2.0 * solution.equations.cost + constant) / (num_points - solution.num_unknowns);
}

MapCovariance BatchEstimator::SetCovariances(const EstimationProblem& problem,
                                             const MotionNoise& found,
                                             ArrowheadEquations equations) {
  CorrectForMotion(motion_noise_, found, problem, &equations);
  MapCovariance covariance = MapCovariance::Of(problem, std::move(equations));
  const std::vector<int>& offsets = covariance.offsets();
  for (size_t i = 0; i < covariance.landmark_ids().size(); ++i) {
    const int size = offsets[i + 1] - offsets[i];
    Landmark& landmark = state_->landmarks[static_cast<size_t>(covariance.landmark_ids()[i])];
    landmark.covariance.setZero();
    landmark.covariance.topLeftCorner(size, size) =
        covariance.landmarks().block(offsets[i], offsets[i], size, size);
  }
  return covariance;
}

}  // namespace plumbline
