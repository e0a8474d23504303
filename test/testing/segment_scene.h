#pragma once

#include <ceres/cost_function.h>

#include <deque>
#include <vector>

#include "factors/cost/segment_factor.h"
#include "factors/segment/segment_group.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/spline.h"
#include "test/testing/factor_testing.h"

namespace plumbline {

inline constexpr int kNumControlPoints = 5;
inline constexpr double kKnotInterval = 0.05;  // s

// Three planes and a cylinder, a rig of two scanners and segments with arbitrary roots on
// them.
struct SegmentScene {
  std::vector<SegmentGroup::Scanner> scanners;
  std::vector<SegmentGroup::Plane> planes = {{PlaneModel::kHorizontal, {-1.0}},
                                             {PlaneModel::kVertical, {}},
                                             {PlaneModel::kGeneral, {}},
                                             {PlaneModel::kCylinder, {}}};
  std::vector<Eigen::VectorXd> plane_parameters;
  std::deque<PackedSegment> measurements;
  std::vector<SegmentGroup::Segment> segments;
  TestBlocks blocks;

  explicit SegmentScene(int num_segments) {
    TestRandom random(11);
    blocks.AddSpline(kNumControlPoints, 0.2, &random);
    for (int i = 0; i < 2; ++i) {
      scanners.push_back({{random.Rotation(1.0).toRotationMatrix(), random.Vector(0.3)}});
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
      for (double& value : measurement.rows.middleCols<3>(9).reshaped())
        value = random.Uniform(-1.0, 1.0);
      measurement.range_rest = random.Uniform(0.0, 1.0);
      measurement.range_offset = random.Uniform(-1.0, 1.0);
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
    return SegmentGroup(
        kNumControlPoints, kKnotInterval, scanners, planes, segments, huber_width);
  }
};

// The segments one by one through their own factors, in the group's tangent space.
struct Expected {
  double cost = 0.0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
};

inline Expected SumOfSegmentFactors(const SegmentScene& scene, double huber_width) {
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
    const ScannerPose& scanner =
        scene.scanners[static_cast<size_t>(segment.scanner)].body_from_scanner;
    blocks.AddRotation(Eigen::Quaterniond(scanner.rotation));
    blocks.AddEuclidean(scanner.translation);
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

}  // namespace plumbline
