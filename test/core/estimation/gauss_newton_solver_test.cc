#include "core/estimation/gauss_newton_solver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/estimation/linearisation.h"
#include "test/core/estimation/solver_cases.h"

namespace plumbline {
namespace {

template <typename Equations>
class GaussNewtonSolverTest : public testing::Test {
 protected:
  const GaussNewtonSolver<Equations> solver_{SolverOptions()};
};
using Shapes = testing::Types<NormalEquations, ArrowheadEquations>;
TYPED_TEST_SUITE(GaussNewtonSolverTest, Shapes);

TYPED_TEST(GaussNewtonSolverTest, EndsAtTheMinimum) {
  ExpectEndsAtTheMinimum(this->solver_, false);
  ExpectEndsAtTheMinimum(this->solver_, true);
}

TYPED_TEST(GaussNewtonSolverTest, WeightsByInformation) {
  ExpectWeightsByInformation(this->solver_);
}

TYPED_TEST(GaussNewtonSolverTest, RefusesWhatIsNotDetermined) {
  ExpectRefusesWhatIsNotDetermined(this->solver_);
}

// Two statements of one rotation that are 2.8 rad apart, and no segments: no step is the last
// one.
class DisagreeingTurns : public PriorProblem {
 public:
  DisagreeingTurns() {
    for (const double half_angle : {0.0, 1.4}) {
      trajectory().control_point(0).rotation = {
          std::sin(half_angle), 0.0, 0.0, std::cos(half_angle)};
      AddPrior({RotationBlock(0)});
    }
  }

  // The cost after so many steps at most, of a new problem.
  template <typename Equations>
  static double CostAfter(const SolverOptions& options) {
    DisagreeingTurns turns;
    return GaussNewtonSolver<Equations>(options).Solve(&turns.problem()).cost;
  }
};

TYPED_TEST(GaussNewtonSolverTest, TakesNoMoreStepsThanItMay) {
  DisagreeingTurns turns;
  const BlockLayout layout = turns.problem().Layout();
  const double before = LineariseDense(turns.problem(), layout).cost;
  SolverOptions none, one;
  none.max_iterations = 0;
  one.max_iterations = 1;
  EXPECT_EQ(DisagreeingTurns::CostAfter<TypeParam>(none), before);
  const double after_one = DisagreeingTurns::CostAfter<TypeParam>(one);
  EXPECT_LT(after_one, 0.9 * before);
  EXPECT_LT(DisagreeingTurns::CostAfter<TypeParam>({}), (1.0 - 1e-6) * after_one);
}

// The last step is the first one that lowers the cost by no more than this.
TYPED_TEST(GaussNewtonSolverTest, ToleranceEndsItEarlier) {
  DisagreeingTurns turns;
  SolverOptions options;
  options.cost_tolerance = 1e9;
  GaussNewtonSolver<TypeParam>(options).Solve(&turns.problem());
  const double cost = LineariseDense(turns.problem(), turns.problem().Layout()).cost;
  EXPECT_GT(cost, (1.0 + 1e-6) * DisagreeingTurns::CostAfter<TypeParam>({}));
  options.cost_tolerance = 0.0;
  options.share_tolerance = 1e9;
  EXPECT_GT(DisagreeingTurns::CostAfter<TypeParam>(options),
            (1.0 + 1e-6) * DisagreeingTurns::CostAfter<TypeParam>({}));
}

TEST(TakeGaussNewtonStepTest, SolvesALinearProblemWhole) {
  PriorProblem priors;
  for (int i = 0; i + 1 < PriorProblem::kNumControlPoints; ++i) {
    priors.AddPrior({PositionBlock(i), PositionBlock(i + 1), LandmarkBlock(0)});
  }
  for (const double size : {0.01, 10.0}) {  // unverified, and verified
    priors.Disturb(size);
    TakeGaussNewtonStep(&priors.problem());
    EXPECT_LT(priors.DistanceFromMean(), 1e-9) << size;
  }
}

TEST(TakeGaussNewtonStepTest, LowersTheCostWhereTurnsAreLarge) {
  PriorProblem priors;
  priors.AddAllPriors();
  priors.Disturb(0.4);
  const BlockLayout layout = priors.problem().Layout();
  const double before = LineariseDense(priors.problem(), layout).cost;
  TakeGaussNewtonStep(&priors.problem());
  EXPECT_LT(LineariseDense(priors.problem(), layout).cost, before);
}

}  // namespace
}  // namespace plumbline
