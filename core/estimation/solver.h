#pragma once

#include <memory>

#include "core/estimation/arrowhead_equations.h"
#include "core/estimation/estimation_problem.h"
#include "core/estimation/normal_equations.h"
#include "core/options/mapper_options.h"

namespace plumbline {

// SolverOptions say when a solver ends.
struct SolverOptions {
  int max_iterations = 30;
  // A step that lowers the cost by no more than either of these is the last one.
  double share_tolerance = 0.0;  // of the cost
  double cost_tolerance = 0.0;
};

// How often a step is shortened that would raise the cost.
inline constexpr int kMaxShortenings = 4;

// Moves the unknowns of an estimation problem to the least cost, and gives the normal
// equations there, from which covariances and the marginal prior come: dense ones
// (NormalEquations) for a window, block arrowhead ones (ArrowheadEquations) for a whole
// recording. Throws Error when the terms do not determine the unknowns.
template <typename Equations>
class Solver {
 public:
  virtual ~Solver() = default;
  virtual Equations Solve(EstimationProblem* problem) const = 0;
};

using WindowSolver = Solver<NormalEquations>;
using BatchSolver = Solver<ArrowheadEquations>;

std::unique_ptr<WindowSolver> MakeWindowSolver(SolverKind kind, const SolverOptions& options);
std::unique_ptr<BatchSolver> MakeBatchSolver(SolverKind kind, const SolverOptions& options);

}  // namespace plumbline
