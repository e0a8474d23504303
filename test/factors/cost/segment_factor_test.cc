#include "factors/cost/segment_factor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "factors/cost/point_factor.h"
#include "factors/segment/segment_compression.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/spline.h"
#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

constexpr int64_t kKnotIntervalNs = 125000000;

SplineNode NodeAt(int64_t time_ns) {
  const int64_t interval = time_ns / kKnotIntervalNs;
  return {
      static_cast<int>(interval),
      static_cast<double>(time_ns % kKnotIntervalNs) / static_cast<double>(kKnotIntervalNs)};
}

std::array<SplineNode, 3> NodesOf(const SegmentMeasurement& measurement) {
  const std::array<int64_t, 3>& times = measurement.node_times_ns;
  return {NodeAt(times[0]), NodeAt(times[1]), NodeAt(times[2])};
}

// The points of a segment with all that its factors need.
struct TestSegment {
  Eigen::Matrix2Xd points;
  std::vector<int64_t> times_ns;
  Eigen::VectorXd whitening;

  // Beams on the line x = 4 m - 0.3 y with noise, from start on, as a scanner takes them.
  static TestSegment Line(int num_points,
                          int64_t start_ns,
                          int64_t step_ns,
                          TestRandom* random) {
    TestSegment segment;
    segment.points.resize(2, num_points);
    segment.whitening.resize(num_points);
    for (int i = 0; i < num_points; ++i) {
      const double y = -3.0 + 6.0 * i / num_points;
      segment.points.col(i) << 4.0 - 0.3 * y + random->Uniform(-0.03, 0.03), y;
      segment.times_ns.push_back(start_ns + i * step_ns);
      segment.whitening[i] = 1.0 / (0.03 * random->Uniform(0.5, 1.0));
    }
    return segment;
  }

  SegmentMeasurement Compress() const { return CompressSegment(points, times_ns, whitening); }
};

// A gently moving rig (rates of the order of 1 rad/s and 1 m/s) in front of a plane. The
// points are not on it: any g serves to compare the two forms of the residual.
TestBlocks GentleMotion(int num_control_points,
                        const Eigen::VectorXd& plane,
                        TestRandom* random) {
  TestBlocks blocks;
  const Eigen::Quaterniond start = random->Rotation(2.0);
  const Eigen::Vector3d rate = random->Vector(0.1), speed = random->Vector(0.1);
  for (int j = 0; j < num_control_points; ++j) {
    blocks.AddRotation(Exp(random->Vector(0.005)) * Exp(j * rate) * start);
  }
  for (int j = 0; j < num_control_points; ++j) {
    blocks.AddEuclidean(j * speed + random->Vector(0.005));
  }
  blocks.AddRotation(random->Rotation(1.0));
  blocks.AddEuclidean(random->Vector(0.3));
  blocks.AddEuclidean(plane);
  return blocks;
}

// The same through one point factor per point. blocks as for the segment.
double SumOfPointFactors(const TestSegment& segment,
                         const TestBlocks& blocks,
                         int num_control_points,
                         PlaneModel model) {
  const std::vector<const double*> all = blocks.pointers();
  const size_t m = static_cast<size_t>(num_control_points);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < segment.points.cols(); ++i) {
    const SplineNode node = NodeAt(segment.times_ns[static_cast<size_t>(i)]);
    const auto factor =
        CreatePointFactor({segment.points.col(i), node.u, segment.whitening[i]}, model, {});
    std::vector<const double*> pointers;
    for (const size_t start : {size_t{0}, m}) {
      for (size_t j = 0; j < 4; ++j) {
        pointers.push_back(all[start + static_cast<size_t>(node.first) + j]);
      }
    }
    pointers.insert(pointers.end(), all.end() - 3, all.end());
    double residual;
    factor->Evaluate(pointers.data(), &residual, nullptr);
    sum += residual * residual;
  }
  return sum;
}

Eigen::VectorXd PlaneParameters(PlaneModel model, TestRandom* random) {
  if (model == PlaneModel::kHorizontal) return Eigen::VectorXd::Constant(1, 2.0);
  if (model == PlaneModel::kVertical) return Eigen::Vector2d(random->Uniform(-3.0, 3.0), 2.0);
  return Eigen::Vector3d(random->Uniform(-1.0, 1.0), random->Uniform(-1.0, 1.0), 2.0);
}

constexpr PlaneModel kModels[] = {
    PlaneModel::kHorizontal, PlaneModel::kVertical, PlaneModel::kGeneral};

TEST(SegmentFactor, OnePointByHand) {
  // The scene of PointFactor.ByHand, distance 0.25 m, whitening 10 / m, weight 2.
  const Eigen::Quaterniond left = Exp(Eigen::Vector3d(0.0, 0.0, 1.57079632679489661923));
  TestBlocks blocks;
  for (int j = 0; j < 4; ++j) blocks.AddRotation(left);
  for (int j = 0; j < 4; ++j) blocks.AddEuclidean(Eigen::Vector3d(1.0, 2.0, 3.0));
  blocks.AddRotation(left);
  blocks.AddEuclidean(Eigen::Vector3d(0.5, 0.0, 0.0));
  blocks.AddEuclidean(Eigen::Vector2d(0.0, -1.25));
  const SegmentMeasurement measurement = CompressSegment(
      Eigen::Vector2d(2.0, 0.0), {50000000}, Eigen::VectorXd::Constant(1, 10.0));
  EXPECT_EQ(measurement.num_nodes, 1);
  const auto factor = CreateSegmentFactor(measurement,
                                          NodesOf(measurement),
                                          4,
                                          PlaneModel::kVertical,
                                          {},
                                          SegmentWeights{2.0, 2.0});
  ASSERT_EQ(factor->num_residuals(), 1);
  EXPECT_NEAR(std::abs(blocks.Residuals(*factor)[0]), 5.0, 1e-12);
  blocks.ExpectGradientsCorrect(*factor);
}

TEST(SegmentFactor, EqualsSumOverPoints) {
  TestRandom random(3);
  // Inside one knot interval, and across a knot.
  for (const int64_t start_ns : {int64_t{20000000}, int64_t{118000000}}) {
    for (const PlaneModel model : kModels) {
      const TestSegment segment = TestSegment::Line(80, start_ns, 92593, &random);
      const SegmentMeasurement measurement = segment.Compress();
      const TestBlocks blocks = GentleMotion(5, PlaneParameters(model, &random), &random);
      const auto factor = CreateSegmentFactor(
          measurement, NodesOf(measurement), 5, model, {}, SegmentWeights{1.0, 1.0});
      const double expected = SumOfPointFactors(segment, blocks, 5, model);
      // The interpolation of g over a span of 7.3 ms leaves out its third derivative, at most
      // about (2 rad/s)^3 (jumps of it at a knot included): 0.064 * 8 / s^3 * (3.7 ms)^3 of
      // 5 m are 1.3e-7 m, 8e-6 standard deviations, of residuals of the order of 100 each.
      EXPECT_NEAR(blocks.Residuals(*factor).squaredNorm() / expected, 1.0, 2e-6);
      EXPECT_LE(factor->num_residuals(), 9);
    }
  }
}

// Offsets of the points move into b and the constant: nothing is lost of the sum of squares.
TEST(SegmentFactor, EqualsSumOverPointsWithOffsets) {
  TestRandom random(8);
  const TestSegment segment = TestSegment::Line(80, 20000000, 92593, &random);
  Eigen::VectorXd offsets(80);
  for (double& offset : offsets) offset = random.Uniform(-2.0, 2.0);
  const SegmentMeasurement measurement =
      CompressSegment(segment.points, segment.times_ns, segment.whitening, offsets);
  const TestBlocks blocks =
      GentleMotion(5, PlaneParameters(PlaneModel::kVertical, &random), &random);
  const std::vector<const double*> all = blocks.pointers();
  constexpr double kScale = 1.3;
  constexpr double kOffset = 0.7;
  double expected = 0.0;
  for (Eigen::Index i = 0; i < 80; ++i) {
    const SplineNode node = NodeAt(segment.times_ns[static_cast<size_t>(i)]);
    const auto factor = CreatePointFactor(
        {segment.points.col(i), node.u, kScale * segment.whitening[i], kOffset * offsets[i]},
        PlaneModel::kVertical,
        {});
    std::vector<const double*> pointers(all.begin(), all.begin() + 4);
    pointers.insert(pointers.end(), all.begin() + 5, all.begin() + 9);
    pointers.insert(pointers.end(), all.end() - 3, all.end());
    double residual;
    factor->Evaluate(pointers.data(), &residual, nullptr);
    expected += residual * residual;
  }
  const auto factor = CreateSegmentFactor(measurement,
                                          NodesOf(measurement),
                                          5,
                                          PlaneModel::kVertical,
                                          {},
                                          SegmentWeights{kScale, kOffset});
  blocks.ExpectGradientsCorrect(*factor);
  const double found =
      blocks.Residuals(*factor).squaredNorm() + kOffset * kOffset * measurement.constant;
  EXPECT_NEAR(found / expected, 1.0, 2e-6);
}

// Without rotation and with evenly accelerated control points g is a quadratic in time: what
// remains is what CompressSegment leaves out.
TEST(SegmentFactor, EqualsSumOverPointsExactlyWhereInterpolationIsExact) {
  TestRandom random(4);
  TestBlocks blocks;
  const Eigen::Quaterniond q = random.Rotation(1.0);
  const Eigen::Vector3d speed = random.Vector(0.2), bend = random.Vector(0.02);
  for (int j = 0; j < 5; ++j) blocks.AddRotation(q);
  for (int j = 0; j < 5; ++j) blocks.AddEuclidean(j * speed + j * j * bend);
  blocks.AddRotation(random.Rotation(1.0));
  blocks.AddEuclidean(random.Vector(0.3));
  blocks.AddEuclidean(Eigen::Vector2d(0.3, 0.5));
  for (const int num_points : {2, 5, 8, 9, 200}) {
    const TestSegment segment = TestSegment::Line(num_points, 118000000, 92593, &random);
    const SegmentMeasurement measurement = segment.Compress();
    const auto factor = CreateSegmentFactor(measurement,
                                            NodesOf(measurement),
                                            5,
                                            PlaneModel::kVertical,
                                            {},
                                            SegmentWeights{1.0, 1.0});
    const double expected = SumOfPointFactors(segment, blocks, 5, PlaneModel::kVertical);
    EXPECT_NEAR(blocks.Residuals(*factor).squaredNorm(), expected, 1e-6 + 1e-10 * expected);
    EXPECT_LE(factor->num_residuals(), std::min(num_points, 9));
  }
}

TEST(SegmentFactor, GradientsOfAMeasuredSegment) {
  TestRandom random(6);
  for (const PlaneModel model : kModels) {
    const TestSegment segment = TestSegment::Line(60, 120000000, 92593, &random);
    const SegmentMeasurement measurement = segment.Compress();
    const TestBlocks blocks = GentleMotion(5, PlaneParameters(model, &random), &random);
    blocks.ExpectGradientsCorrect(*CreateSegmentFactor(
        measurement, NodesOf(measurement), 5, model, {}, SegmentWeights{1.0, 1.0}));
  }
}

TEST(SegmentFactor, ZeroOnPerfectDataWithCorrectGradients) {
  // A rig at rest at the origin in front of the wall x = 4, scanning horizontally.
  TestSegment segment;
  segment.points.resize(2, 50);
  segment.whitening = Eigen::VectorXd::Constant(50, 30.0);
  for (int i = 0; i < 50; ++i) {
    segment.points.col(i) << 3.5, -2.0 + 0.1 * i;
    segment.times_ns.push_back(100000 * i);
  }
  TestBlocks blocks;
  for (int j = 0; j < 4; ++j) blocks.AddRotation(Eigen::Quaterniond::Identity());
  for (int j = 0; j < 4; ++j) blocks.AddEuclidean(Eigen::Vector3d::Zero());
  blocks.AddRotation(Eigen::Quaterniond::Identity());
  blocks.AddEuclidean(Eigen::Vector3d(0.5, 0.0, 0.0));
  blocks.AddEuclidean(Eigen::Vector2d(0.0, 4.0));
  const SegmentMeasurement measurement = segment.Compress();
  const auto factor = CreateSegmentFactor(measurement,
                                          NodesOf(measurement),
                                          4,
                                          PlaneModel::kVertical,
                                          {},
                                          SegmentWeights{1.0, 1.0});
  EXPECT_LT(blocks.Residuals(*factor).norm(), 1e-10);
  blocks.ExpectGradientsCorrect(*factor);
}

TEST(SegmentFactor, ControlPointsOutsideTheSupportHaveNoEffect) {
  TestRandom random(7);
  const TestSegment segment = TestSegment::Line(60, 20000000, 92593, &random);
  const SegmentMeasurement measurement = segment.Compress();
  TestBlocks blocks = GentleMotion(6, Eigen::Vector2d(0.3, 2.0), &random);
  const auto factor = CreateSegmentFactor(measurement,
                                          NodesOf(measurement),
                                          6,
                                          PlaneModel::kVertical,
                                          {},
                                          SegmentWeights{1.0, 1.0});
  const Eigen::VectorXd residuals = blocks.Residuals(*factor);
  const Eigen::MatrixXd jacobian = blocks.TangentJacobian(*factor);
  // Tangents: six rotations, six positions, extrinsics, plane. The segment uses the first
  // four.
  EXPECT_EQ(jacobian.middleCols(12, 6).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(jacobian.middleCols(30, 6).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_GT(jacobian.middleCols(9, 3).norm(), 0.0);
  EXPECT_GT(jacobian.middleCols(27, 3).norm(), 0.0);
  blocks[4] = random.Rotation(1.0).coeffs();
  blocks[10] = random.Vector(9.0);
  EXPECT_EQ(blocks.Residuals(*factor), residuals);
}

TEST(CompressSegment, NodesSpanTheSegment) {
  TestRandom random(10);
  const TestSegment segment = TestSegment::Line(4, 1000, 333, &random);
  const SegmentMeasurement measurement = segment.Compress();
  EXPECT_EQ(measurement.num_nodes, 3);
  EXPECT_EQ(measurement.node_times_ns[0], 1000);
  EXPECT_EQ(measurement.node_times_ns[1], 1499);
  EXPECT_EQ(measurement.node_times_ns[2], 1998);  // 1 ns before the last point: equal halves
}

TEST(CompressSegment, PointsOfOneInstantNeedOneNode) {
  TestRandom random(11);
  const TestSegment segment = TestSegment::Line(40, 1000, 0, &random);
  const SegmentMeasurement measurement = segment.Compress();
  EXPECT_EQ(measurement.num_nodes, 1);
  EXPECT_LE(measurement.rows.rows(), 3);
  EXPECT_EQ(measurement.root().rightCols(6).norm(), 0.0);
  const Eigen::Vector3d g(0.6, 0.7, -2.0);
  const Eigen::VectorXd distances = (segment.points.transpose() * g.head<2>()).array() + g[2];
  const Eigen::VectorXd residuals = measurement.root().leftCols<3>() * g;
  EXPECT_NEAR(
      residuals.squaredNorm(), distances.cwiseProduct(segment.whitening).squaredNorm(), 1e-6);
}

// Points in a line, taken at one instant of a rig that moves on a level floor, on a cylinder:
// the segment's residuals, its bow and the rest of that included, lose nothing of the points'.
TEST(SegmentFactor, OnACylinderEqualsSumOverPoints) {
  TestRandom random(9);
  TestSegment segment;
  segment.points.resize(2, 40);
  segment.whitening = Eigen::VectorXd::Constant(40, 50.0);
  Eigen::VectorXd offsets(40);
  for (int i = 0; i < 40; ++i) {
    segment.points.col(i) << 4.0, -1.5 + 0.07 * i;
    segment.times_ns.push_back(30000000);
    offsets[i] = random.Uniform(-2.0, 2.0);
  }
  const SegmentMeasurement measurement =
      CompressSegment(segment.points, segment.times_ns, segment.whitening, offsets);
  const SplineNode node = NodeAt(30000000);
  for (const double curvature : {-0.25, 0.1}) {
    TestBlocks blocks;
    for (int j = 0; j < 4; ++j) blocks.AddRotation(Exp(Eigen::Vector3d(0.0, 0.0, 0.1 * j)));
    for (int j = 0; j < 4; ++j) blocks.AddEuclidean(Eigen::Vector3d(0.05 * j, 0.3, 0.0));
    blocks.AddRotation(Exp(Eigen::Vector3d(0.0, 0.0, 0.4)));
    blocks.AddEuclidean(Eigen::Vector3d(0.1, 0.0, 0.2));
    blocks.AddEuclidean(Eigen::Vector3d(3.0, curvature, 0.02));
    PlaneChart chart;
    chart.anchor = {3.5, 2.0, 0.0};
    const std::vector<const double*> pointers = blocks.pointers();
    double expected = 0.0;
    for (int i = 0; i < 40; ++i) {
      const auto factor = CreatePointFactor(
          {segment.points.col(i), node.u, 1.3 * segment.whitening[i], 0.7 * offsets[i]},
          PlaneModel::kCylinder,
          chart);
      double residual;
      factor->Evaluate(pointers.data(), &residual, nullptr);
      expected += residual * residual;
    }
    const auto factor = CreateSegmentFactor(measurement,
                                            NodesOf(measurement),
                                            4,
                                            PlaneModel::kCylinder,
                                            chart,
                                            SegmentWeights{1.3, 0.7});
    const double found =
        blocks.Residuals(*factor).squaredNorm() +
        0.7 * 0.7 * (measurement.constant - measurement.bend_offset * measurement.bend_offset);
    EXPECT_NEAR(found / expected, 1.0, 1e-9);
  }
}

TEST(SegmentFactor, GradientsOfASegmentOnACylinder) {
  TestRandom random(10);
  for (int i = 0; i < 4; ++i) {
    const TestSegment segment = TestSegment::Line(60, 120000000, 92593, &random);
    SegmentMeasurement measurement = segment.Compress();
    // The flattening of the bow as the rig tilts is left out of the derivatives.
    measurement.rows.col(10).setZero();
    measurement.bend_rest = 0.0;
    const TestBlocks blocks =
        GentleMotion(5, Eigen::Vector3d(random.Uniform(-3.0, 3.0), -0.2, 0.1), &random);
    blocks.ExpectGradientsCorrect(*CreateSegmentFactor(measurement,
                                                       NodesOf(measurement),
                                                       5,
                                                       PlaneModel::kCylinder,
                                                       {},
                                                       SegmentWeights{1.0, 1.0}));
  }
}

}  // namespace
}  // namespace plumbline
