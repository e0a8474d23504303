#include "core/estimation/solver.h"

#include <gtest/gtest.h>

#include "core/estimation/ceres_solver.h"
#include "test/core/estimation/solver_cases.h"

namespace plumbline {
namespace {

// Whether solving has called Ceres.
template <typename Equations>
bool CallsCeres(const Solver<Equations>& solver) {
  PriorProblem priors;
  priors.AddAllPriors();
  priors.Disturb(0.02);
  const int64_t before = NumCeresSolves();
  solver.Solve(&priors.problem());
  EXPECT_LT(priors.DistanceFromMean(), 1e-6);
  return NumCeresSolves() > before;
}

TEST(SolverTest, KindSaysWhoSolves) {
  EXPECT_TRUE(CallsCeres(*MakeWindowSolver(SolverKind::kCeres, {})));
  EXPECT_TRUE(CallsCeres(*MakeBatchSolver(SolverKind::kCeres, {})));
  EXPECT_FALSE(CallsCeres(*MakeWindowSolver(SolverKind::kGaussNewton, {})));
  EXPECT_FALSE(CallsCeres(*MakeBatchSolver(SolverKind::kGaussNewton, {})));
}

TEST(SolverTest, OptionsArePassedOn) {
  SolverOptions options;
  options.max_iterations = 0;
  PriorProblem priors;
  priors.AddAllPriors();
  priors.Disturb(0.02);
  const double before = priors.DistanceFromMean();
  MakeWindowSolver(SolverKind::kGaussNewton, options)->Solve(&priors.problem());
  MakeBatchSolver(SolverKind::kGaussNewton, options)->Solve(&priors.problem());
  EXPECT_EQ(priors.DistanceFromMean(), before);
}

}  // namespace
}  // namespace plumbline
