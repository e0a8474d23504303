#include "core/estimation/ceres_solver.h"

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <glog/logging.h>

#include <set>
#include <vector>

#include "core/estimation/linearisation.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

// The cost functions and manifolds belong to the terms and to the estimation problem.
ceres::Problem::Options Ownership() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
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

CeresProblem::CeresProblem(const EstimationProblem& problem)
    : segments_(problem.MakeSegmentTerms()),
      problem_(std::make_unique<ceres::Problem>(Ownership())) {
  for (const FactorTerm& term : problem.factor_terms()) AddTerm(term);
  for (const FactorTerm& term : segments_) AddTerm(term);
  std::set<const double*> unknowns;
  for (const BlockId& block : problem.Layout().blocks) {
    double* const data = problem.Data(block);
    unknowns.insert(data);
    if (!problem_->HasParameterBlock(data)) continue;
    if (const ceres::Manifold* const manifold = problem.ManifoldOf(block)) {
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

void CeresProblem::AddTerm(const FactorTerm& term) {
  problem_->AddResidualBlock(
      const_cast<ceres::CostFunction*>(term.factor.get()),
      term.huber_width > 0.0 ? new ceres::HuberLoss(term.huber_width) : nullptr,
      term.blocks);
}

template <typename Equations>
Equations CeresSolver<Equations>::Solve(EstimationProblem* problem) const {
  const CeresProblem ceres_problem(*problem);
  ceres::Solver::Options options;
  // SPARSE_SCHUR with the planes eliminated first is 30 times slower: they see everything.
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  // What the solvers start from is close, and damping would only slow the weakly determined
  // directions, the shape of a long loop above all.
  options.initial_trust_region_radius = 1e12;
  options.max_num_iterations = options_.max_iterations;
  constexpr double kLeastTolerance = 1e-9;  // of the cost, where the caller sets none
  options.function_tolerance =
      options_.share_tolerance > 0.0 ? options_.share_tolerance : kLeastTolerance;
  options.num_threads = 1;  // Ceres sums costs by thread: more would change the result
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, ceres_problem.get(), &summary);
  VLOG(1) << summary.BriefReport();
  if (!summary.IsSolutionUsable()) throw Error("the estimation failed: " + summary.message);
  return Linearise<Equations>(*problem);
}

template class CeresSolver<NormalEquations>;
template class CeresSolver<ArrowheadEquations>;

}  // namespace plumbline
