#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/estimation/solver.h"

namespace ceres {
class Problem;
}

namespace plumbline {

// CeresProblem is an estimation problem as Ceres takes it: one residual block for each group
// of segments (CreateGroupFactor) or for each segment (CreateSegmentFactor, with
// ceres::HuberLoss where it has one), one for each other factor, and every unknown with its
// manifold. Extrinsics and held unknowns are constant blocks. Refers to the estimation
// problem, which outlives it.
class CeresProblem {
 public:
  enum class Segments { kInGroups, kOneByOne };
  CeresProblem(const EstimationProblem& problem, Segments segments);
  ~CeresProblem();

  ceres::Problem* get() const { return problem_.get(); }

 private:
  void AddTerm(const FactorTerm& term);

  std::vector<FactorTerm> terms_;  // made for Ceres; all other terms are the problem's own
  std::unique_ptr<ceres::Problem> problem_;
};

// Returns the number of calls of ceres::Solve in this process.
int64_t NumCeresSolves();

// Solves by ceres::Solve, DENSE_NORMAL_CHOLESKY or SPARSE_NORMAL_CHOLESKY by size, with a
// trust region so wide that the steps are those of Gauss-Newton.
template <typename Equations>
class CeresSolver final : public Solver<Equations> {
 public:
  explicit CeresSolver(const SolverOptions& options,
                       CeresProblem::Segments segments = CeresProblem::Segments::kInGroups)
      : options_(options), segments_(segments) {}
  Equations Solve(EstimationProblem* problem) const override;

 private:
  SolverOptions options_;
  CeresProblem::Segments segments_;
};

}  // namespace plumbline
