#include <ceres/cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "factors/cost/point_factor.h"
#include "factors/cost/position_factor.h"
#include "factors/cost/segment_factor.h"
#include "factors/manifold/manifolds.h"
#include "factors/segment/segment_compression.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

// A rig of three scanners moves through a box-shaped room for 0.37 s along a path that is no
// spline. The trajectory and the six planes are estimated twice: from one factor per
// point and from one factor per segment.

constexpr double kPi = 3.14159265358979323846;
constexpr double kRangeNoise = 0.01;
constexpr int64_t kKnotIntervalNs = 125000000;
constexpr int kNumIntervals = 3;
constexpr int kNumControlPoints = kNumIntervals + 3;
constexpr int kNumScans = 15;
constexpr int kNumBeams = 54;  // over 270 degrees in 18.75 ms

struct RoomPlane {
  PlaneModel model;
  PlaneChart chart;
  Eigen::VectorXd params;
  Eigen::Vector3d normal;  // into the room
  double distance;
};

std::vector<RoomPlane> Room() {
  const auto wall = [](double angle, double distance) {
    const Eigen::Vector3d normal(std::cos(angle), std::sin(angle), 0.0);
    return RoomPlane{
        PlaneModel::kVertical, {}, Eigen::Vector2d(angle, distance), normal, distance};
  };
  const auto level = [](double sign) {
    return RoomPlane{PlaneModel::kHorizontal,
                     {sign},
                     Eigen::VectorXd::Constant(1, -1.5),
                     sign * Eigen::Vector3d::UnitZ(),
                     -1.5};
  };
  return {wall(0.0, -3.0),
          wall(kPi, -3.0),
          wall(kPi / 2, -2.5),
          wall(-kPi / 2, -2.5),
          level(1.0),
          level(-1.0)};
}

SplinePose TruePose(double t) {
  SplinePose pose;
  pose.position << 0.8 * std::sin(1.3 * t), 0.6 * std::sin(1.7 * t), 0.1 * std::sin(2.1 * t);
  pose.world_from_body = Exp(Eigen::Vector3d(0.0, 0.0, std::sin(0.9 * t))) *
                         Exp(Eigen::Vector3d(0.05 * std::sin(2.0 * t), 0.0, 0.0)) *
                         Exp(Eigen::Vector3d(0.0, 0.05 * std::cos(1.5 * t), 0.0));
  return pose;
}

// The paper's rig: one horizontal scanner, two tilted by 45 degrees to the front left and
// right.
std::vector<SplinePose> Scanners() {
  const Eigen::Quaterniond tilt = Exp(Eigen::Vector3d(0.0, kPi / 4, 0.0));
  return {{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.3}},
          {Exp(Eigen::Vector3d(0.0, 0.0, kPi / 4)) * tilt, {0.1, 0.2, 0.0}},
          {Exp(Eigen::Vector3d(0.0, 0.0, -kPi / 4)) * tilt, {0.1, -0.2, 0.0}}};
}

struct SimulatedSegment {
  size_t scanner, plane;
  Eigen::Matrix2Xd points;
  std::vector<int64_t> times_ns;
  Eigen::VectorXd whitening;

  void Append(const Eigen::Vector2d& point, int64_t time_ns, double weight) {
    const Eigen::Index size = points.cols();
    points.conservativeResize(2, size + 1);
    points.col(size) = point;
    times_ns.push_back(time_ns);
    whitening.conservativeResize(size + 1);
    whitening[size] = weight;
  }
};

std::vector<SimulatedSegment> Scan(const std::vector<RoomPlane>& room) {
  std::mt19937 engine(1);
  std::normal_distribution<double> noise(0.0, kRangeNoise);
  const std::vector<SplinePose> scanners = Scanners();
  std::vector<SimulatedSegment> segments;
  for (int scan = 0; scan < kNumScans; ++scan) {
    for (size_t scanner = 0; scanner < scanners.size(); ++scanner) {
      bool first_beam = true;
      for (int beam = 0; beam < kNumBeams; ++beam) {
        const int64_t time_ns = scan * 25000000LL + beam * 347222LL;
        const SplinePose body = TruePose(static_cast<double>(time_ns) * 1e-9);
        const Eigen::Vector3d origin =
            body.world_from_body * scanners[scanner].position + body.position;
        const double angle = (beam * 5.0 - 135.0) * kPi / 180.0;
        const Eigen::Vector3d beam_scanner(std::cos(angle), std::sin(angle), 0.0);
        const Eigen::Vector3d beam_world =
            body.world_from_body * (scanners[scanner].world_from_body * beam_scanner);
        double range = std::numeric_limits<double>::infinity();
        size_t hit = 0;
        for (size_t i = 0; i < room.size(); ++i) {
          const double slope = room[i].normal.dot(beam_world);
          if (slope >= 0.0) continue;
          const double candidate = (room[i].distance - room[i].normal.dot(origin)) / slope;
          if (candidate < range) {
            range = candidate;
            hit = i;
          }
        }
        if (first_beam || segments.back().plane != hit) {
          segments.push_back({scanner, hit, {}, {}, {}});
        }
        first_beam = false;
        segments.back().Append((range + noise(engine)) * beam_scanner.head<2>(),
                               time_ns,
                               1.0 / (kRangeNoise * -room[hit].normal.dot(beam_world)));
      }
    }
  }
  return segments;
}

SplineNode NodeAt(int64_t time_ns) {
  return {
      static_cast<int>(time_ns / kKnotIntervalNs),
      static_cast<double>(time_ns % kKnotIntervalNs) / static_cast<double>(kKnotIntervalNs)};
}

// All unknowns, and the problem to estimate them from either kind of factor.
class Estimate {
 public:
  Estimate(const std::vector<RoomPlane>& room, const std::vector<SimulatedSegment>& segments)
      : room_(room), segments_(segments), scanners_(Scanners()) {
    for (int j = 0; j < kNumControlPoints; ++j) {
      const SplinePose pose = TruePose((j - 1) * 0.125);
      rotations_.push_back(pose.world_from_body);
      positions_.push_back(pose.position);
    }
    for (const RoomPlane& plane : room) {
      planes_.push_back(plane.params);
      planes_.back().array() += 0.02;
    }
    planes_[0][0] = 0.0;  // heading of the model frame
  }

  void AddPointFactors() {
    for (const SimulatedSegment& segment : segments_) {
      for (Eigen::Index i = 0; i < segment.points.cols(); ++i) {
        const SplineNode node = NodeAt(segment.times_ns[static_cast<size_t>(i)]);
        const RoomPlane& plane = room_[segment.plane];
        problem_.AddResidualBlock(
            CreatePointFactor({segment.points.col(i), node.u, segment.whitening[i]},
                              plane.model,
                              plane.chart)
                .release(),
            nullptr,
            Blocks(node.first, 4, segment));
      }
    }
  }

  void AddSegmentFactors() {
    for (const SimulatedSegment& segment : segments_) {
      const SegmentMeasurement measurement =
          CompressSegment(segment.points, segment.times_ns, segment.whitening);
      std::array<SplineNode, 3> nodes;
      for (size_t k = 0; k < 3; ++k) nodes[k] = NodeAt(measurement.node_times_ns[k]);
      const int first = nodes[0].first;
      const int num_control_points = nodes[2].first - first + 4;
      for (SplineNode& node : nodes) node.first -= first;
      const RoomPlane& plane = room_[segment.plane];
      problem_.AddResidualBlock(CreateSegmentFactor(measurement,
                                                    nodes,
                                                    num_control_points,
                                                    plane.model,
                                                    plane.chart,
                                                    SegmentWeights{})
                                    .release(),
                                nullptr,
                                Blocks(first, num_control_points, segment));
    }
  }

  // Returns the sum of squared residuals.
  double Solve() {
    for (Eigen::Quaterniond& q : rotations_) {
      problem_.SetManifold(q.coeffs().data(), CreateRotationManifold().release());
    }
    problem_.SetManifold(planes_[0].data(), new ceres::SubsetManifold(2, {0}));
    for (SplinePose& scanner : scanners_) {
      problem_.SetParameterBlockConstant(scanner.world_from_body.coeffs().data());
      problem_.SetParameterBlockConstant(scanner.position.data());
    }
    problem_.AddResidualBlock(
        CreatePositionFactor(TruePose(0.0).position, 0.0, 1e-4).release(),
        nullptr,
        positions_[0].data(),
        positions_[1].data(),
        positions_[2].data(),
        positions_[3].data());
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.function_tolerance = 1e-13;
    options.gradient_tolerance = 1e-16;
    options.max_num_iterations = 20;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    EXPECT_TRUE(summary.IsSolutionUsable()) << summary.FullReport();
    return 2.0 * summary.final_cost;
  }

  const std::vector<Eigen::VectorXd>& planes() const { return planes_; }
  SplinePose Pose(int64_t time_ns) const {
    const SplineNode node = NodeAt(time_ns);
    const double* q[4];
    const double* p[4];
    for (size_t j = 0; j < 4; ++j) {
      q[j] = rotations_[static_cast<size_t>(node.first) + j].coeffs().data();
      p[j] = positions_[static_cast<size_t>(node.first) + j].data();
    }
    return EvaluatePose(q, p, node.u, nullptr);
  }
  int num_unknowns() const { return 6 * kNumControlPoints + 4 * 2 - 1 + 2 - 3; }

 private:
  std::vector<double*> Blocks(int first,
                              int num_control_points,
                              const SimulatedSegment& segment) {
    std::vector<double*> blocks;
    const size_t start = static_cast<size_t>(first);
    const size_t end = start + static_cast<size_t>(num_control_points);
    for (size_t j = start; j < end; ++j) blocks.push_back(rotations_[j].coeffs().data());
    for (size_t j = start; j < end; ++j) blocks.push_back(positions_[j].data());
    blocks.push_back(scanners_[segment.scanner].world_from_body.coeffs().data());
    blocks.push_back(scanners_[segment.scanner].position.data());
    blocks.push_back(planes_[segment.plane].data());
    return blocks;
  }

  const std::vector<RoomPlane>& room_;
  const std::vector<SimulatedSegment>& segments_;
  std::vector<SplinePose> scanners_;
  std::vector<Eigen::Quaterniond> rotations_;
  std::vector<Eigen::Vector3d> positions_;
  std::vector<Eigen::VectorXd> planes_;
  ceres::Problem problem_;
};

TEST(SegmentRoom, SegmentsGiveTheEstimateOfTheirPoints) {
  const std::vector<RoomPlane> room = Room();
  const std::vector<SimulatedSegment> segments = Scan(room);
  Estimate by_point(room, segments), by_segment(room, segments);
  by_point.AddPointFactors();
  by_segment.AddSegmentFactors();
  const double sum_by_point = by_point.Solve();
  const double sum_by_segment = by_segment.Solve();

  double plane_difference = 0.0, rotation_difference = 0.0, position_difference = 0.0;
  for (size_t i = 0; i < room.size(); ++i) {
    plane_difference =
        std::max(plane_difference,
                 (by_point.planes()[i] - by_segment.planes()[i]).cwiseAbs().maxCoeff());
  }
  // The poses, not the control points: the last ones are only weakly determined.
  for (int scan = 0; scan < kNumScans; ++scan) {
    const SplinePose one = by_point.Pose(scan * 25000000LL);
    const SplinePose other = by_segment.Pose(scan * 25000000LL);
    rotation_difference =
        std::max(rotation_difference,
                 Log(one.world_from_body * other.world_from_body.conjugate()).norm());
    position_difference =
        std::max(position_difference, (one.position - other.position).norm());
  }
  EXPECT_LT(plane_difference, 1e-5);  // m and rad
  EXPECT_LT(rotation_difference, 1e-5);
  EXPECT_LT(position_difference, 1e-5);

  // Both sums of squares are chi-squared with N - unknowns degrees of freedom: five sigma.
  const double num_points = kNumScans * 3 * kNumBeams;
  const double degrees = num_points - by_point.num_unknowns();
  EXPECT_NEAR(sum_by_point, degrees, 5.0 * std::sqrt(2.0 * degrees));
  EXPECT_NEAR(sum_by_segment / sum_by_point, 1.0, 1e-6);
}

}  // namespace
}  // namespace plumbline
