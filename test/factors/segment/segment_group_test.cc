#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <vector>

#include "factors/cost/group_factor.h"
#include "factors/cost/segment_factor.h"
#include "factors/segment/linearised_group.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/spline.h"
#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

constexpr int kNumControlPoints = 5;

// Three planes and a cylinder, a rig of two scanners and segments with arbitrary roots on
// them.
struct Scene {
  std::vector<SegmentGroup::Scanner> scanners;
  std::vector<SegmentGroup::Plane> planes = {{PlaneModel::kHorizontal, {-1.0}},
                                             {PlaneModel::kVertical, {}},
                                             {PlaneModel::kGeneral, {}},
                                             {PlaneModel::kCylinder, {}}};
  std::vector<Eigen::VectorXd> plane_parameters;
  std::deque<PackedSegment> measurements;
  std::vector<SegmentGroup::Segment> segments;
  TestBlocks blocks;

  explicit Scene(int num_segments) {
    TestRandom random(11);
    blocks.AddSpline(kNumControlPoints, 0.2, &random);
    for (int i = 0; i < 2; ++i) {
      scanners.push_back({random.Rotation(1.0).toRotationMatrix(), random.Vector(0.3)});
    }
    plane_parameters = {Eigen::VectorXd::Constant(1, 2.0), Eigen::Vector2d(0.4, -3.0)};
    planes[2].chart = random.Chart();
    plane_parameters.emplace_back(Eigen::Vector3d(0.3, -0.7, 1.5));
    planes[3].chart.anchor = random.Vector(3.0);
    plane_parameters.emplace_back(Eigen::Vector3d(-0.8, -0.3, 0.1));
    for (size_t i = 0; i < planes.size(); ++i) {
      blocks.AddEuclidean(plane_parameters[i]);
    }
    for (int i = 0; i < num_segments; ++i) {
      SegmentMeasurement measurement;
      measurement.num_nodes = i % 4 == 0 ? 1 : 3;
      if (measurement.num_nodes == 3) measurement.node_times_ns = {0, 1, 2};
      measurement.rows.setZero(2 + i % 6, SegmentMeasurement::kColumns);
      for (double& value : measurement.rows.leftCols(3 * measurement.num_nodes).reshaped()) {
        value = random.Uniform(-1.0, 1.0);
      }
      for (double& value : measurement.rows.rightCols<2>().reshaped())
        value = random.Uniform(-1.0, 1.0);
      SegmentGroup::Segment segment;
      const Eigen::Vector2d origin(random.Uniform(-5.0, 5.0), random.Uniform(-5.0, 5.0));
      const Eigen::Vector2d tangent = random.Vector(1.0).head<2>().normalized();
      const SegmentFrame frame = {origin.cast<float>(), tangent.cast<float>()};
      segment.measurement = &measurements.emplace_back(measurement, frame);
      const double u = random.Uniform(0.0, 0.8);
      segment.nodes = {SplineNode{0, u}, SplineNode{0, u + 0.1}, SplineNode{i % 2, u + 0.2}};
      segment.scanner = i % 2;
      segment.plane = i % 4;
      // A group keeps them in single precision.
      segment.weights = {static_cast<float>(random.Uniform(0.5, 2.0)),
                         static_cast<float>(random.Uniform(0.5, 1.0))};
      segments.push_back(segment);
    }
  }

  SegmentGroup Group(double huber_width) const {
    return SegmentGroup(kNumControlPoints, scanners, planes, segments, huber_width);
  }
};

// The segments one by one through their own factors, in the group's tangent space.
struct Expected {
  double cost = 0.0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
};

Expected SumOfSegmentFactors(const Scene& scene, double huber_width) {
  const Eigen::Index size =
      scene.blocks.size() == 0 ? 0 : 6 * kNumControlPoints + 1 + 2 + 3 + 3;
  Expected expected;
  expected.gradient.setZero(size);
  expected.hessian.setZero(size, size);
  const int plane_at[] = {6 * kNumControlPoints,
                          6 * kNumControlPoints + 1,
                          6 * kNumControlPoints + 3,
                          6 * kNumControlPoints + 6};
  const int plane_size[] = {1, 2, 3, 3};  // tangents
  for (const SegmentGroup::Segment& segment : scene.segments) {
    TestBlocks blocks;
    TestRandom random(11);
    blocks.AddSpline(kNumControlPoints, 0.2, &random);
    const SegmentGroup::Scanner& scanner =
        scene.scanners[static_cast<size_t>(segment.scanner)];
    blocks.AddRotation(Eigen::Quaterniond(scanner.body_from_scanner_rotation));
    blocks.AddEuclidean(scanner.body_from_scanner_translation);
    const auto plane = static_cast<size_t>(segment.plane);
    blocks.AddEuclidean(scene.plane_parameters[plane]);
    const auto factor = CreateSegmentFactor(segment.measurement->Unpack(),
                                            segment.nodes,
                                            kNumControlPoints,
                                            scene.planes[plane].model,
                                            scene.planes[plane].chart,
                                            segment.weights);
    const Eigen::VectorXd residuals = blocks.Residuals(*factor);
    const Eigen::MatrixXd all = blocks.TangentJacobian(*factor);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(residuals.size(), size);
    const int poses = 6 * kNumControlPoints;
    jacobian.leftCols(poses) = all.leftCols(poses);
    jacobian.middleCols(plane_at[plane], plane_size[plane]) = all.rightCols(plane_size[plane]);
    const double norm = residuals.norm();
    const bool outlier = huber_width > 0.0 && norm > huber_width;
    const double weight = outlier ? huber_width / norm : 1.0;
    expected.cost +=
        outlier ? huber_width * (norm - 0.5 * huber_width) : 0.5 * residuals.squaredNorm();
    expected.gradient += weight * jacobian.transpose() * residuals;
    expected.hessian += weight * jacobian.transpose() * jacobian;
  }
  return expected;
}

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
      const Scene scene(num_segments);
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
  const Scene scene(60);
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

// As a cost function it takes the same steps, with a loss or without, and where few segments
// leave directions free.
TEST(SegmentGroup, TheCostFunctionTakesTheStepsOfTheSegments) {
  for (const int num_segments : {3, 60}) {
    for (const double huber_width : {0.0, 3.0}) {
      const Scene scene(num_segments);
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

TEST(SegmentGroup, HuberTouchesSomeSegmentsOnly) {
  const Scene scene(60);
  const double plain = SumOfSegmentFactors(scene, 0.0).cost;
  const double robust = SumOfSegmentFactors(scene, 3.0).cost;
  const double very_wide = SumOfSegmentFactors(scene, 1e6).cost;
  EXPECT_LT(robust, 0.95 * plain);
  EXPECT_EQ(very_wide, plain);
}

// A group remembers its last linearisation: it must not serve parameters far from it.
TEST(SegmentGroup, FollowsItsParameters) {
  Scene scene(30);
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
  Scene scene(60);
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
  const Scene scene(60);
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
