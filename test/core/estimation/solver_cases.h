#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/estimation/solver.h"
#include "core/util/error.h"
#include "test/core/estimation/prior_problem.h"

namespace plumbline {

// What every solver has to do, on problems of which the solution is known.

template <typename Equations>
void ExpectEndsAtTheMinimum(const Solver<Equations>& solver, bool planar) {
  PriorProblem priors(planar);
  priors.AddAllPriors();
  priors.Disturb(0.02);
  EXPECT_GT(priors.DistanceFromMean(), 0.02);
  const Equations equations = solver.Solve(&priors.problem());
  EXPECT_LT(priors.DistanceFromMean(), 1e-6);
  EXPECT_LT(equations.gradient.norm(), 1e-4);
  EXPECT_LT(equations.cost, 1e-10);
}

// Two statements of one position: 1 m with a standard deviation of 0.1 m and 2 m with one of
// 0.2 m give 1.2 m, and a cost of (2^2 + 4^2) / 2.
template <typename Equations>
void ExpectWeightsByInformation(const Solver<Equations>& solver) {
  PriorProblem priors;
  double& x = priors.trajectory().control_point(0).position[0];
  for (const double stated : {1.0, 2.0}) {
    x = stated;
    priors.AddPrior({PositionBlock(0)},
                    Eigen::Vector3d(10.0 / stated, 1.0, 1.0).asDiagonal().toDenseMatrix());
  }
  x = -3.0;
  const Equations equations = solver.Solve(&priors.problem());
  EXPECT_NEAR(x, 1.2, 1e-9);
  EXPECT_NEAR(equations.cost, 10.0, 1e-9);
}

template <typename Equations>
void ExpectRefusesWhatIsNotDetermined(const Solver<Equations>& solver) {
  PriorProblem priors;
  priors.AddPrior({PositionBlock(0), LandmarkBlock(0)},
                  Eigen::Vector4d(1.0, 0.0, 1.0, 1.0).asDiagonal().toDenseMatrix());
  priors.Disturb(1.0);
  EXPECT_THROW(solver.Solve(&priors.problem()), Error);
}

}  // namespace plumbline
