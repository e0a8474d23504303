#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "factors/segment/linearised_group.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/spline.h"
#include "test/testing/segment_scene.h"

namespace plumbline {
namespace {

// The group's rows in the order of the parameter blocks: rotations, positions, planes.
std::vector<int> RowsByBlock(int size) {
  std::vector<int> rows;
  for (const int first : {0, 3}) {
    for (int row = 0; row < 6 * kNumControlPoints; ++row) {
      if (row % 6 / 3 * 3 == first) rows.push_back(row);
    }
  }
  for (int row = 6 * kNumControlPoints; row < size; ++row) rows.push_back(row);
  return rows;
}

Eigen::MatrixXd HessianByBlock(const Eigen::MatrixXd& lower, const std::vector<int>& rows) {
  const Eigen::MatrixXd full = lower.selfadjointView<Eigen::Lower>();
  return full(rows, rows);
}

// Few segments leave directions free, many do not.
TEST(SegmentGroup, ModelEqualsItsSegments) {
  for (const int num_segments : {3, 60}) {
    for (const double huber_width : {0.0, 3.0}) {
      const SegmentScene scene(num_segments);
      const Expected expected = SumOfSegmentFactors(scene, huber_width);
      LinearisedGroup group(scene.Group(huber_width));
      const LinearisedGroup::Model model = group.ModelAt(scene.blocks.pointers().data());
      EXPECT_NEAR(model.cost, expected.cost, 1e-10 * expected.cost);
      const int size = 6 * kNumControlPoints + 3;  // before the plane with a manifold
      const std::vector<int> rows = RowsByBlock(size);
      EXPECT_LT((model.gradient(rows) - expected.gradient.head(size)).norm(),
                1e-8 * expected.gradient.norm());
      EXPECT_LT(
          (HessianByBlock(model.hessian, rows) - expected.hessian.topLeftCorner(size, size))
              .norm(),
          1e-10 * expected.hessian.norm());
    }
  }
}

TEST(SegmentGroup, WithPlanesHeldThePosesRowsAreLeft) {
  const SegmentScene scene(60);
  const Expected expected = SumOfSegmentFactors(scene, 3.0);
  const std::vector<const double*> parameters = scene.blocks.pointers();
  SegmentGroup::Quadratic quadratic;
  scene.Group(3.0).LinearisePoses(parameters.data(), &quadratic);
  const Eigen::Index size = 6 * kNumControlPoints;
  EXPECT_NEAR(quadratic.cost, expected.cost, 1e-10 * expected.cost);
  ASSERT_EQ(quadratic.gradient.size(), size);
  const std::vector<int> rows = RowsByBlock(static_cast<int>(size));
  EXPECT_LT((quadratic.gradient(rows) - expected.gradient.head(size)).norm(),
            1e-8 * expected.gradient.norm());
  EXPECT_LT(
      (HessianByBlock(quadratic.hessian, rows) - expected.hessian.topLeftCorner(size, size))
          .norm(),
      1e-10 * expected.hessian.norm());
}

TEST(SegmentGroup, HuberTouchesSomeSegmentsOnly) {
  const SegmentScene scene(60);
  const double plain = SumOfSegmentFactors(scene, 0.0).cost;
  const double robust = SumOfSegmentFactors(scene, 3.0).cost;
  const double very_wide = SumOfSegmentFactors(scene, 1e6).cost;
  EXPECT_LT(robust, 0.95 * plain);
  EXPECT_EQ(very_wide, plain);
}

// A group remembers its last linearisation: it must not serve parameters far from it.
TEST(SegmentGroup, FollowsItsParameters) {
  SegmentScene scene(30);
  LinearisedGroup group(scene.Group(0.0));
  const double before = group.ModelAt(scene.blocks.pointers().data()).cost;
  scene.blocks[kNumControlPoints][0] += 0.1;
  const double moved = group.ModelAt(scene.blocks.pointers().data()).cost;
  EXPECT_EQ(group.num_linearisations(), 2);
  LinearisedGroup anew(scene.Group(0.0));
  EXPECT_EQ(anew.ModelAt(scene.blocks.pointers().data()).cost, moved);
  scene.blocks[kNumControlPoints][0] -= 0.1;
  EXPECT_NEAR(group.ModelAt(scene.blocks.pointers().data()).cost, before, 1e-9 * before);
}

// Positions enter the residuals of planes linearly, so that the model of a plain sum of
// squares is exact however far they move within its validity.
TEST(SegmentGroup, ModelHoldsNearItsLinearisation) {
  SegmentScene scene(60);
  scene.segments.erase(std::remove_if(scene.segments.begin(),
                                      scene.segments.end(),
                                      [&](const SegmentGroup::Segment& segment) {
                                        const auto plane = static_cast<size_t>(segment.plane);
                                        return scene.planes[plane].model ==
                                               PlaneModel::kCylinder;
                                      }),
                       scene.segments.end());
  LinearisedGroup group(scene.Group(0.0));
  group.ModelAt(scene.blocks.pointers().data());
  scene.blocks[kNumControlPoints][0] += 0.005;
  const LinearisedGroup::Model model = group.ModelAt(scene.blocks.pointers().data());
  EXPECT_EQ(group.num_linearisations(), 1);
  LinearisedGroup anew(scene.Group(0.0));
  const LinearisedGroup::Model exact = anew.ModelAt(scene.blocks.pointers().data());
  EXPECT_NEAR(model.cost, exact.cost, 1e-9 * exact.cost);
  const Eigen::Index size = 6 * kNumControlPoints;
  EXPECT_LT((model.gradient - exact.gradient).head(size).norm(), 0.01 * exact.gradient.norm())
      << "the lever arms have moved by 5 mm";
}

TEST(SegmentGroup, WithPlanesHeldItsModelIsAboutThePoses) {
  const SegmentScene scene(60);
  LinearisedGroup group(scene.Group(3.0), true);
  const LinearisedGroup::Model model = group.ModelAt(scene.blocks.pointers().data());
  const Expected expected = SumOfSegmentFactors(scene, 3.0);
  const int size = 6 * kNumControlPoints;
  ASSERT_EQ(model.gradient.size(), size);
  EXPECT_NEAR(model.cost, expected.cost, 1e-10 * expected.cost);
  EXPECT_LT((model.gradient(RowsByBlock(size)) - expected.gradient.head(size)).norm(),
            1e-8 * expected.gradient.norm());
}

}  // namespace
}  // namespace plumbline
