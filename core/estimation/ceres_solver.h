#pragma once

#include <memory>
#include <vector>

#include "core/estimation/solver.h"

namespace ceres {
class Problem;
}

namespace plumbline {

// CeresProblem is an estimation problem as Ceres takes it: one residual block for each segment
// (CreateSegmentFactor, with ceres::HuberLoss where it has one), one for each other factor,
// and every unknown with its manifold. Extrinsics and held unknowns are constant blocks.
// Refers to the estimation problem, which outlives it.
class CeresProblem {
 public:
  explicit CeresProblem(const EstimationProblem& problem);
  ~CeresProblem();

  ceres::Problem* get() const { return problem_.get(); }

 private:
  void AddTerm(const FactorTerm& term);

  std::vector<FactorTerm> segments_;  // made for Ceres; all other terms are the problem's own
  std::unique_ptr<ceres::Problem> problem_;
};

// Solves by ceres::Solve: SPARSE_NORMAL_CHOLESKY with a trust region so wide that the steps
// are those of Gauss-Newton. For reading, for trying new residuals, and to check the default,
// GaussNewtonSolver; docs/estimation.md has both times.
template <typename Equations>
class CeresSolver final : public Solver<Equations> {
 public:
  explicit CeresSolver(const SolverOptions& options) : options_(options) {}
  Equations Solve(EstimationProblem* problem) const override;

 private:
  SolverOptions options_;
};

}  // namespace plumbline
