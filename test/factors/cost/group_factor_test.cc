#include "factors/cost/group_factor.h"

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <memory>

#include "test/testing/segment_scene.h"

namespace plumbline {
namespace {

// It takes the steps of its segments, with a loss or without, and where few segments
// leave directions free.
TEST(GroupFactor, TakesTheStepsOfTheSegments) {
  for (const int num_segments : {3, 60}) {
    for (const double huber_width : {0.0, 3.0}) {
      const SegmentScene scene(num_segments);
      const Expected expected = SumOfSegmentFactors(scene, huber_width);
      const auto factor =
          CreateGroupFactor(std::make_shared<LinearisedGroup>(scene.Group(huber_width)));
      EXPECT_NEAR(0.5 * scene.blocks.Residuals(*factor).squaredNorm(),
                  expected.cost,
                  1e-10 * expected.cost);
      Eigen::VectorXd residuals;
      const Eigen::MatrixXd jacobian = scene.blocks.TangentJacobian(*factor, &residuals);
      EXPECT_NEAR(0.5 * residuals.squaredNorm(), expected.cost, 1e-10 * expected.cost);
      const int size = 6 * kNumControlPoints + 3;  // before the plane with a manifold
      EXPECT_LT((jacobian.transpose() * residuals - expected.gradient).head(size).norm(),
                1e-7 * expected.gradient.norm());
      EXPECT_LT((jacobian.transpose() * jacobian - expected.hessian)
                    .topLeftCorner(size, size)
                    .norm(),
                1e-9 * expected.hessian.norm());
    }
  }
}

// Held planes are constant blocks: the rows are the poses' alone.
TEST(GroupFactor, HeldPlanesHaveNoRows) {
  const SegmentScene scene(60);
  const auto factor =
      CreateGroupFactor(std::make_shared<LinearisedGroup>(scene.Group(0.0), true));
  EXPECT_EQ(factor->num_residuals(), 6 * kNumControlPoints + 1);
  EXPECT_NEAR(0.5 * scene.blocks.Residuals(*factor).squaredNorm(),
              SumOfSegmentFactors(scene, 0.0).cost,
              1e-8 * SumOfSegmentFactors(scene, 0.0).cost);
}

}  // namespace
}  // namespace plumbline
