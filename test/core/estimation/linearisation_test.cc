// Segments: segment_groups_test.cc, and end_to_end/covariance_test.cc.

#include "core/estimation/linearisation.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "core/estimation/arrowhead_cholesky.h"
#include "test/core/estimation/prior_problem.h"

namespace plumbline {
namespace {

TEST(LinearisationTest, AtTheirMeanPriorsAreTheirRoots) {
  PriorProblem priors;
  priors.AddAllPriors();
  const NormalEquations equations =
      LineariseDense(priors.problem(), priors.problem().Layout());
  const Eigen::MatrixXd expected = priors.Hessian();
  ASSERT_EQ(equations.size(), 6 * PriorProblem::kNumControlPoints + 1 + 3);
  EXPECT_LT((equations.hessian - expected).norm(), 1e-10 * expected.norm());
  EXPECT_LT(equations.gradient.norm(), 1e-12);
  EXPECT_LT(equations.cost, 1e-20);
}

TEST(LinearisationTest, GradientIsThatOfTheCost) {
  constexpr double kStep = 1e-5;
  for (const bool planar : {false, true}) {
    PriorProblem priors(planar);
    priors.AddAllPriors();
    priors.Disturb(0.05);
    const BlockLayout layout = priors.problem().Layout();
    const std::vector<int> free = layout.FreeColumns();
    const NormalEquations equations = LineariseDense(priors.problem(), layout);
    const Unknowns& unknowns = priors.problem().unknowns();
    const Unknowns::Values values = unknowns.ValuesOf(layout);
    for (size_t i = 0; i < free.size(); ++i) {
      double cost[2];
      for (const int side : {0, 1}) {
        Eigen::VectorXd step = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(free.size()));
        step[static_cast<Eigen::Index>(i)] = side == 0 ? -kStep : kStep;
        unknowns.Move(layout, step);
        cost[side] = LineariseDense(priors.problem(), layout).cost;
        unknowns.SetValues(layout, values);
      }
      EXPECT_NEAR((cost[1] - cost[0]) / (2.0 * kStep),
                  equations.gradient[free[i]],
                  1e-6 * equations.gradient.norm())
          << free[i];
    }
  }
}

TEST(LinearisationTest, ArrowheadIsTheSameSystem) {
  for (const bool planar : {false, true}) {
    PriorProblem priors(planar);
    priors.AddAllPriors();
    priors.Disturb(0.05);
    const BlockLayout layout = priors.problem().Layout();
    NormalEquations dense = LineariseDense(priors.problem(), layout);
    ArrowheadEquations arrowhead = LineariseArrowhead(priors.problem(), layout);
    EXPECT_NEAR(arrowhead.cost, dense.cost, 1e-12 * dense.cost);
    EXPECT_LT((arrowhead.gradient - dense.gradient).norm(), 1e-12 * dense.gradient.norm());
    // Held directions: nothing in the one, a unit diagonal in the other.
    int num_held = 0;
    for (int i = 0; i < layout.size(); ++i) {
      if (layout.is_free[static_cast<size_t>(i)]) continue;
      EXPECT_EQ(dense.hessian.row(i).norm() + dense.hessian.col(i).norm(), 0.0);
      EXPECT_EQ(dense.gradient[i], 0.0);
      dense.hessian(i, i) = 1.0;
      ++num_held;
    }
    EXPECT_EQ(num_held, planar ? PriorProblem::kNumControlPoints : 0);
    EXPECT_LT((arrowhead.diagonal - dense.hessian.diagonal()).norm(),
              1e-12 * arrowhead.diagonal.norm());
    const Eigen::VectorXd right_side = Eigen::VectorXd::LinSpaced(layout.size(), -1.0, 2.0);
    const Eigen::VectorXd solution = dense.hessian.llt().solve(right_side);
    const ArrowheadCholesky cholesky(std::move(arrowhead.hessian), BorderElimination::kLast);
    EXPECT_LT((cholesky.Solve(right_side) - solution).norm(), 1e-8 * solution.norm());
  }
}

TEST(LinearisationTest, VisitedFactorsAddUpToTheSystem) {
  PriorProblem priors;
  priors.AddAllPriors();
  priors.Disturb(0.05);
  const BlockLayout layout = priors.problem().Layout();
  const NormalEquations equations = LineariseDense(priors.problem(), layout);
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(layout.size(), layout.size());
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(layout.size());
  int num_visited = 0;
  const ResidualVisitor visit = [&](const std::vector<int>& columns,
                                    const Eigen::MatrixXd& jacobian,
                                    const Eigen::VectorXd& residuals) {
    EXPECT_TRUE(std::is_sorted(columns.begin(), columns.end()));
    hessian(columns, columns) += jacobian.transpose() * jacobian;
    gradient(columns) += jacobian.transpose() * residuals;
    ++num_visited;
  };
  VisitFactors(priors.problem(), layout, FactorTerm::Kind::kImu, visit);
  EXPECT_EQ(num_visited, 0);
  VisitFactors(priors.problem(), layout, std::nullopt, visit);
  EXPECT_EQ(num_visited, PriorProblem::kNumControlPoints - 1);
  EXPECT_LT((hessian - equations.hessian).norm(), 1e-10 * hessian.norm());
  EXPECT_LT((gradient - equations.gradient).norm(), 1e-10 * gradient.norm());
  EXPECT_EQ(NumGroupLinearisations(priors.problem()), 0);
}

}  // namespace
}  // namespace plumbline
