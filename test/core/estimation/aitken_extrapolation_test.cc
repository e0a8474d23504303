#include "core/estimation/aitken_extrapolation.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

const Eigen::Vector3d kWeights(1.0, 100.0, 0.01);

// Along one direction only a tenth of the way is taken, by steps of any lengthening.
TEST(StepLength, GoesTheWholeWay) {
  const Eigen::Vector3d way(3.0, -0.2, 7.0);
  constexpr double kShare = 0.1;
  for (const double last_lengthening : {1.0, 2.5, 4.0}) {
    const Eigen::Vector3d last_step = kShare * way;
    const Eigen::Vector3d rest = way - last_lengthening * last_step;
    const Eigen::Vector3d step = kShare * rest;
    const double lengthening = AitkenRelaxation(step, last_step, last_lengthening, kWeights);
    EXPECT_LT((lengthening * step - rest).norm(), 1e-12 * way.norm()) << last_lengthening;
  }
}

TEST(StepLength, LeavesOtherStepsAsTheyAre) {
  const Eigen::Vector3d last_step(1.0, 0.1, 0.0);
  EXPECT_EQ(AitkenRelaxation(0.4 * last_step, last_step, 1.0, kWeights),
            1.0);  // they converge
  EXPECT_EQ(AitkenRelaxation(-0.9 * last_step, last_step, 1.0, kWeights),
            1.0);  // it went too far
  EXPECT_EQ(AitkenRelaxation(Eigen::Vector3d(1.0, -0.1, 0.0), last_step, 1.0, kWeights), 1.0);
  EXPECT_EQ(AitkenRelaxation(Eigen::Vector3d(0.0, 0.0, 0.0), last_step, 1.0, kWeights), 1.0);
  EXPECT_EQ(AitkenRelaxation(last_step, Eigen::Vector3d::Zero(), 1.0, kWeights), 1.0);
}

// Steps that do not become shorter tell no end.
TEST(StepLength, IsBounded) {
  const Eigen::Vector3d last_step(1.0, 0.1, 0.0);
  EXPECT_EQ(AitkenRelaxation(last_step, last_step, 1.0, kWeights), 20.0);
  EXPECT_EQ(AitkenRelaxation(1.5 * last_step, last_step, 1.0, kWeights), 20.0);
  EXPECT_EQ(AitkenRelaxation(0.6 * last_step, last_step, 0.3, kWeights), 1.0);
}

}  // namespace
}  // namespace plumbline
