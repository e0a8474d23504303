#pragma once

#include <memory>

#include "core/estimation/solver.h"

namespace ceres {
class Problem;
}

namespace plumbline {

// The estimation problem as Ceres takes it: one residual block for each segment
// (CreateSegmentFactor, with ceres::HuberLoss where it has one), one for each other factor,
// and every unknown with its manifold. Extrinsics and held unknowns are constant blocks.
// Refers to the estimation problem, which outlives it.
std::unique_ptr<ceres::Problem> MakeCeresProblem(const EstimationProblem& problem);

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
