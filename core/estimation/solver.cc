#include "core/estimation/solver.h"

#include "core/estimation/ceres_solver.h"
#include "core/estimation/gauss_newton_solver.h"

namespace plumbline {
namespace {

template <typename Equations>
std::unique_ptr<Solver<Equations>> MakeSolver(SolverKind kind, const SolverOptions& options) {
  if (kind == SolverKind::kCeres) return std::make_unique<CeresSolver<Equations>>(options);
  return std::make_unique<GaussNewtonSolver<Equations>>(options);
}

}  // namespace

std::unique_ptr<WindowSolver> MakeWindowSolver(SolverKind kind, const SolverOptions& options) {
  return MakeSolver<NormalEquations>(kind, options);
}

std::unique_ptr<BatchSolver> MakeBatchSolver(SolverKind kind, const SolverOptions& options) {
  return MakeSolver<ArrowheadEquations>(kind, options);
}

}  // namespace plumbline
