#pragma once

#include "core/estimation/solver.h"

namespace plumbline {

// Gauss-Newton on the normal equations, which the covariances need anyway: by a dense Cholesky
// factorisation (NormalEquations) or the block arrowhead one (ArrowheadEquations). A step that
// would raise the cost is halved. The solver ends after a step that lowers the cost by no more
// than the tolerance, or by what the quadratic model expected to within it: the next step
// would lower it no further. Of a dense problem, a step that is expected to lower the cost by
// no more than the tolerance is taken unverified; the equations are then those before it.
template <typename Equations>
class GaussNewtonSolver final : public Solver<Equations> {
 public:
  explicit GaussNewtonSolver(const SolverOptions& options) : options_(options) {}
  Equations Solve(EstimationProblem* problem) const override;

 private:
  SolverOptions options_;
};

// Takes the first step alone, on block arrowhead equations. Whether it lowers the cost is
// verified only where it moves a control point far: verifying takes as long as the step.
void TakeGaussNewtonStep(EstimationProblem* problem);

}  // namespace plumbline
