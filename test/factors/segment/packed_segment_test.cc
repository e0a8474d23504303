#include "factors/segment/packed_segment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "factors/segment/segment_compression.h"
#include "factors/segment/segment_measurement.h"
#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

constexpr int kNumPoints = 500;
constexpr double kWhitening = 300.0;  // 1 / m

// A segment of 10 m, 30 m away from the scanner, within 10 ms.
struct FarSegment {
  SegmentFrame frame;
  SegmentMeasurement measurement;

  FarSegment() {
    frame.origin = {21.3F, -20.7F};
    frame.tangent = {0.6F, 0.8F};
    Eigen::Matrix2Xd points(2, kNumPoints);
    std::vector<int64_t> times_ns;
    TestRandom random(2);
    Eigen::VectorXd offsets(kNumPoints);
    for (int i = 0; i < kNumPoints; ++i) {
      const double along = 10.0 * i / (kNumPoints - 1) - 5.0;
      points.col(i) = frame.origin.cast<double>() + along * frame.tangent.cast<double>();
      times_ns.push_back(1'000'000'000'000'000 + 20'000 * i);
      offsets[i] = random.Uniform(-2.0, 2.0);
    }
    measurement = CompressSegment(
        points, times_ns, Eigen::VectorXd::Constant(kNumPoints, kWhitening), offsets);
  }

  // g of a plane that deviates from the segment by so much, at the three nodes.
  Eigen::Matrix<double, 9, 1> Geometry(double offset_m, double slope) const {
    Eigen::Matrix<double, 9, 1> g;
    for (int k = 0; k < 3; ++k) {
      const double turn = (1.0 + 0.1 * k) * slope;
      const Eigen::Vector2d tangent = frame.tangent.cast<double>();
      const Eigen::Vector2d across(-tangent.y(), tangent.x());
      const Eigen::Vector2d normal = std::cos(turn) * across + std::sin(turn) * tangent;
      g.segment<3>(3 * k) << normal,
          (1.0 + 0.2 * k) * offset_m - normal.dot(frame.origin.cast<double>());
    }
    return g;
  }
};

TEST(PackedSegment, ResidualsAreThoseOfTheMeasurement) {
  const FarSegment segment;
  const PackedSegment stored(segment.measurement, segment.frame);
  const SegmentMeasurement unpacked = stored.Unpack();
  ASSERT_EQ(unpacked.rows.rows(), segment.measurement.rows.rows());
  for (const double offset_m : {0.0, 0.001, 0.05}) {
    for (const double slope : {0.0, 0.001, 0.02}) {
      const Eigen::Matrix<double, 9, 1> g = segment.Geometry(offset_m, slope);
      const Eigen::VectorXd expected =
          segment.measurement.root() * g + segment.measurement.offset();
      const Eigen::VectorXd found = unpacked.root() * g + unpacked.offset();
      // Each of a row's ten terms is rounded by 6e-8 of itself; the largest is the residual of
      // all points together.
      const double whole =
          std::sqrt(kNumPoints) * (kWhitening * (offset_m + 5.0 * slope) + 2.0);
      EXPECT_LT((found - expected).norm(), 6e-8 * 10.0 * whole);
      EXPECT_LT((found - expected).norm(), 2e-3) << "standard deviations of one range";
    }
  }
}

// In the scanner's frame as many bits would not do: 3e-8 of 30 m, for 500 points at once.
TEST(PackedSegment, ScannersFrameWouldRoundTheRange) {
  const FarSegment segment;
  const Eigen::Matrix<double, 9, 1> g = segment.Geometry(0.0, 0.0);
  const Eigen::MatrixXd root = segment.measurement.root();
  const Eigen::VectorXd expected = root * g;
  const Eigen::VectorXd rounded = root.cast<float>().cast<double>() * g;
  const Eigen::VectorXd stored =
      PackedSegment(segment.measurement, segment.frame).Unpack().root() * g;
  EXPECT_GT((rounded - expected).norm(), 10.0 * (stored - expected).norm());
}

TEST(PackedSegment, KeepsNodes) {
  const FarSegment segment;
  const PackedSegment stored(segment.measurement, segment.frame);
  EXPECT_EQ(stored.node_times_ns(), segment.measurement.node_times_ns);
  EXPECT_EQ(stored.num_nodes(), 3);
  EXPECT_NEAR(stored.constant() / segment.measurement.constant, 1.0, 1e-7);
  EXPECT_EQ(stored.frame().origin, segment.frame.origin);

  const SegmentMeasurement instant = CompressSegment(
      Eigen::Vector2d(2.0, 0.0), {50'000'000}, Eigen::VectorXd::Constant(1, 10.0));
  const PackedSegment of_instant(instant, {{2.0F, 0.0F}, {0.0F, 1.0F}});
  EXPECT_EQ(of_instant.num_nodes(), 1);
  EXPECT_EQ(of_instant.Unpack().num_nodes, 1);
  EXPECT_LT((of_instant.Unpack().root() - instant.root()).norm(), 1e-5);
}

TEST(SegmentFrame, MapsAlongAndAcrossToTheScanPlane) {
  const SegmentFrame frame = {{3.0F, -1.0F}, {0.0F, 1.0F}};
  const Eigen::Vector3d p = frame.Matrix() * Eigen::Vector3d(2.0, 0.5, 1.0);
  EXPECT_LT((p - Eigen::Vector3d(2.5, 1.0, 1.0)).norm(), 1e-15);
}

}  // namespace
}  // namespace plumbline
