#include "factors/cost/position_factor.h"

#include <gtest/gtest.h>

#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

TEST(PositionFactor, ByHandAtAKnot) {
  TestBlocks blocks;
  for (const double x : {6.0, 12.0, 0.0, 1e6}) {  // the last one has no weight at a knot
    blocks.AddEuclidean(Eigen::Vector3d(x, 0.0, 1.0));
  }
  const auto factor = CreatePositionFactor(Eigen::Vector3d(8.0, 0.0, 0.0), 0.0, 0.5);
  // (6 + 4 * 12 + 0) / 6 = 9.
  EXPECT_LT((blocks.Residuals(*factor) - Eigen::Vector3d(2.0, 0.0, 2.0)).norm(), 1e-12);
}

TEST(PositionFactor, ZeroOnTheSplineAndGradients) {
  TestRandom random(3);
  TestBlocks blocks;
  for (int j = 0; j < 4; ++j) blocks.AddEuclidean(random.Vector(5.0));
  const auto at_origin = CreatePositionFactor(Eigen::Vector3d::Zero(), 0.3, 1.0);
  const Eigen::Vector3d on_spline = blocks.Residuals(*at_origin);
  const auto factor = CreatePositionFactor(on_spline, 0.3, 1e-3);
  EXPECT_LT(blocks.Residuals(*factor).norm(), 1e-12);
  blocks.ExpectGradientsCorrect(*factor);
  blocks.ExpectGradientsCorrect(*at_origin);
}

}  // namespace
}  // namespace plumbline
