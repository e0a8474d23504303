#include "core/estimation/ceres_solver.h"

#include <ceres/problem.h>
#include <gtest/gtest.h>

#include "core/estimation/linearisation.h"
#include "test/core/estimation/solver_cases.h"

namespace plumbline {
namespace {

template <typename Equations>
class CeresSolverTest : public testing::Test {
 protected:
  const CeresSolver<Equations> solver_{SolverOptions()};
};
using Shapes = testing::Types<NormalEquations, ArrowheadEquations>;
TYPED_TEST_SUITE(CeresSolverTest, Shapes);

TYPED_TEST(CeresSolverTest, EndsAtTheMinimum) {
  ExpectEndsAtTheMinimum(this->solver_, false);
  ExpectEndsAtTheMinimum(this->solver_, true);
}

TYPED_TEST(CeresSolverTest, WeightsByInformation) {
  ExpectWeightsByInformation(this->solver_);
}

TYPED_TEST(CeresSolverTest, CountsItsSolutions) {
  PriorProblem priors;
  priors.AddAllPriors();
  const int64_t before = NumCeresSolves();
  this->solver_.Solve(&priors.problem());
  EXPECT_GT(NumCeresSolves(), before);
}

TYPED_TEST(CeresSolverTest, EquationsAreThoseOfTheEnd) {
  PriorProblem priors;
  priors.AddAllPriors();
  priors.Disturb(0.02);
  const TypeParam equations = this->solver_.Solve(&priors.problem());
  const NormalEquations now = LineariseDense(priors.problem(), priors.problem().Layout());
  EXPECT_EQ(equations.cost, now.cost);
  EXPECT_LT((equations.gradient - now.gradient).norm(), 1e-12);
}

TEST(CeresProblemTest, UnknownsHaveTheirManifolds) {
  PriorProblem priors(true);
  priors.AddAllPriors();
  const CeresProblem problem(priors.problem(), CeresProblem::Segments::kInGroups);
  constexpr int kNum = PriorProblem::kNumControlPoints;
  EXPECT_EQ(problem.get()->NumResidualBlocks(), kNum - 1);
  EXPECT_EQ(problem.get()->NumParameterBlocks(), 2 * kNum + 2);
  // A turn about the vertical, and a shift in the plane.
  const Unknowns& unknowns = priors.problem().unknowns();
  EXPECT_EQ(problem.get()->ParameterBlockTangentSize(unknowns.Data(RotationBlock(0))), 1);
  EXPECT_EQ(problem.get()->ParameterBlockTangentSize(unknowns.Data(PositionBlock(0))), 2);
  double cost = -1.0;
  problem.get()->Evaluate({}, &cost, nullptr, nullptr, nullptr);
  EXPECT_NEAR(cost, 0.0, 1e-20);
}

TEST(CeresProblemTest, WhatIsHeldIsConstant) {
  PriorProblem priors;
  priors.problem().HoldLandmarks();
  priors.problem().HoldControlPointsBefore(3);
  priors.AddAllPriors();
  const CeresProblem problem(priors.problem(), CeresProblem::Segments::kInGroups);
  const Unknowns& unknowns = priors.problem().unknowns();
  for (int i = 0; i < PriorProblem::kNumControlPoints; ++i) {
    EXPECT_EQ(problem.get()->IsParameterBlockConstant(unknowns.Data(PositionBlock(i))), i < 3);
  }
  EXPECT_TRUE(problem.get()->IsParameterBlockConstant(unknowns.Data(LandmarkBlock(0))));
}

}  // namespace
}  // namespace plumbline
