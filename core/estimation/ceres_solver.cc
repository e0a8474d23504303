#include "core/estimation/ceres_solver.h"

#include <ceres/cost_function.h>
#include <ceres/iteration_callback.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <glog/logging.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "core/estimation/linearisation.h"
#include "core/util/error.h"
#include "factors/cost/group_factor.h"

namespace plumbline {
namespace {

// The cost functions and manifolds belong to the terms and to the estimation problem.
ceres::Problem::Options Ownership() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

std::atomic<int64_t> num_solves = 0;

// A tracker's problem has fewer, a window's more: dense factors are faster for the one, sparse
// ones for the other.
constexpr int kFewResiduals = 150;

// Ends a solution where another step would find nothing: after one that lowered the cost by no
// more than the tolerance, or, being whole, by what its quadratic model said to within that,
// or that no group had to be linearised anew for; and at the first whole step that would have
// raised the cost.
class LastStep final : public ceres::IterationCallback {
 public:
  LastStep(const SolverOptions& options, const EstimationProblem& problem, bool shortened)
      : options_(options), problem_(problem), shortened_(shortened) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    const int num_before =
        std::exchange(num_linearisations_, NumGroupLinearisations(problem_));
    if (step.iteration == 0) return ceres::SOLVER_CONTINUE;
    const double tolerance = std::max(
        options_.cost_tolerance, options_.share_tolerance * (step.cost + step.cost_change));
    if (!step.step_is_successful) {
      // At the minimum a step that would gain next to nothing fails by rounding.
      has_failed_ = !(step.cost_change / step.relative_decrease <= tolerance);
      return shortened_ ? ceres::SOLVER_CONTINUE : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    }
    has_failed_ = false;
    const double off_model = step.cost_change * std::abs(1.0 / step.relative_decrease - 1.0);
    const bool is_linear =
        !problem_.group_terms().empty() && num_linearisations_ == num_before;
    is_done_ = step.cost_change <= tolerance ||
               (!shortened_ && (off_model <= tolerance || is_linear));
    return is_done_ ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

  bool is_done() const { return is_done_; }
  bool has_failed() const { return has_failed_; }  // the last one

 private:
  const SolverOptions& options_;
  const EstimationProblem& problem_;
  bool shortened_;
  bool is_done_ = false;
  bool has_failed_ = false;
  int num_linearisations_ = 0;
};

std::vector<FactorTerm> GroupTermsOf(const EstimationProblem& problem) {
  std::vector<FactorTerm> terms;
  for (const GroupTerm& group : problem.group_terms()) {
    FactorTerm term;
    term.factor = CreateGroupFactor(group.group);
    term.blocks = group.blocks;
    terms.push_back(std::move(term));
  }
  return terms;
}

template <typename Equations>
Equations Linearise(const EstimationProblem& problem);
template <>
NormalEquations Linearise(const EstimationProblem& problem) {
  return LineariseDense(problem, problem.Layout());
}
template <>
ArrowheadEquations Linearise(const EstimationProblem& problem) {
  return LineariseArrowhead(problem, problem.Layout());
}

}  // namespace

CeresProblem::CeresProblem(const EstimationProblem& problem, Segments segments)
    : terms_(segments == Segments::kInGroups ? GroupTermsOf(problem)
                                             : problem.MakeSegmentTerms()),
      problem_(std::make_unique<ceres::Problem>(Ownership())) {
  for (const FactorTerm& term : problem.factor_terms()) AddTerm(term);
  for (const FactorTerm& term : terms_) AddTerm(term);
  std::set<const double*> unknowns;
  for (const BlockId& block : problem.Layout().blocks) {
    double* const data = problem.unknowns().Data(block);
    unknowns.insert(data);
    if (!problem_->HasParameterBlock(data)) continue;
    if (const ceres::Manifold* const manifold = problem.unknowns().ManifoldOf(block)) {
      problem_->SetManifold(data, const_cast<ceres::Manifold*>(manifold));
    }
  }
  std::vector<double*> blocks;
  problem_->GetParameterBlocks(&blocks);
  for (double* const block : blocks) {
    if (unknowns.count(block) == 0) problem_->SetParameterBlockConstant(block);
  }
}

CeresProblem::~CeresProblem() = default;

int64_t NumCeresSolves() { return num_solves; }

void CeresProblem::AddTerm(const FactorTerm& term) {
  problem_->AddResidualBlock(
      const_cast<ceres::CostFunction*>(term.factor.get()),
      term.huber_width > 0.0 ? new ceres::HuberLoss(term.huber_width) : nullptr,
      term.blocks);
}

template <typename Equations>
Equations CeresSolver<Equations>::Solve(EstimationProblem* problem) const {
  const CeresProblem ceres_problem(*problem, segments_);
  ceres::Solver::Options options;
  // SPARSE_SCHUR with the planes eliminated first is 30 times slower: they see everything.
  options.linear_solver_type = ceres_problem.get()->NumResiduals() < kFewResiduals
                                   ? ceres::DENSE_NORMAL_CHOLESKY
                                   : ceres::SPARSE_NORMAL_CHOLESKY;
  constexpr double kLeastTolerance = 1e-9;  // of the cost, where the caller sets none
  options.function_tolerance =
      options_.share_tolerance > 0.0 ? options_.share_tolerance : kLeastTolerance;
  options.num_threads = 1;  // Ceres sums costs by thread: more would change the result
  options.logging_type = VLOG_IS_ON(2) ? ceres::PER_MINIMIZER_ITERATION : ceres::SILENT;
  ceres::Solver::Summary summary;
  const auto solve = [&](bool shortened) {
    // What the solvers start from is close, and damping would only slow the weakly determined
    // directions, the shape of a long loop above all. Where a whole step is too long, half of
    // it, as damping by the normal matrix' diagonal gives, and less where that fails.
    constexpr double kNoDamping = 1e12;
    LastStep last_step(options_, *problem, shortened);
    options.initial_trust_region_radius = shortened ? 1.0 : kNoDamping;
    options.max_num_iterations = shortened ? kMaxShortenings : options_.max_iterations;
    if (segments_ == CeresProblem::Segments::kInGroups) options.callbacks = {&last_step};
    ++num_solves;
    ceres::Solve(options, ceres_problem.get(), &summary);
    VLOG(1) << summary.BriefReport();
    return last_step;
  };
  for (int i = 0; i < options_.max_iterations; ++i) {
    if (!solve(false).has_failed()) break;
    const LastStep shortened = solve(true);
    if (shortened.has_failed() || shortened.is_done()) break;
    // Ceres has ended by its own tolerance, before it asked LastStep. At the minimum whole
    // steps fail by rounding, and shortened ones gain nothing, as often as they are tried.
    if (summary.termination_type == ceres::CONVERGENCE) break;
  }
  if (!summary.IsSolutionUsable()) throw Error("the estimation failed: " + summary.message);
  return Linearise<Equations>(*problem);
}

template class CeresSolver<NormalEquations>;
template class CeresSolver<ArrowheadEquations>;

}  // namespace plumbline
