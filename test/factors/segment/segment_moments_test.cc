#include "factors/segment/segment_moments.h"

#include <gtest/gtest.h>

#include <cmath>

#include "factors/segment/segment_measurement.h"
#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

// Points of a wall 2 m away, seen over 6 m of it: the cosine between beam and wall changes
// along the segment, which no plane imitates.
SegmentMoments WallWithRangesTooLong(double range_bias_m) {
  constexpr size_t kNumPoints = SegmentMoments::kBlock;
  SegmentMoments moments({-3.0, 2.0}, {3.0, 2.0}, 0, 10'000'000);
  SegmentMoments::Points points;
  TestRandom random(3);
  for (size_t i = 0; i < kNumPoints; ++i) {
    const double share = static_cast<double>(i) / (kNumPoints - 1);
    points.x[i] = -3.0 + 6.0 * share;
    points.y[i] = 2.0;
    points.since_start_ns[i] = 1e7 * share;
    const double cosine = 2.0 / std::hypot(points.x[i], 2.0);
    points.weight[i] = 1.0 / std::pow(0.03 * cosine, 2);
    points.by_range[i] = cosine;
    points.offset[i] = cosine * (random.Uniform(-0.05, 0.05) + range_bias_m);
  }
  moments.Add(points, kNumPoints);
  return moments;
}

TEST(SegmentMoments, RowsKnowWhatARangeBiasDoes) {
  constexpr double kBias = 0.02;
  const std::array<int64_t, 3> nodes = NodesOfSpan(0, 10'000'000);
  const SegmentMeasurement biased = WallWithRangesTooLong(kBias).Compress(nodes);
  const SegmentMeasurement right = WallWithRangesTooLong(0.0).Compress(nodes);
  EXPECT_LT((biased.root() - right.root()).norm(), 1e-9 * right.root().norm());
  EXPECT_GT(kBias * right.range().norm(), 1.0) << "in standard deviations";
  EXPECT_LT((biased.offset() - kBias * biased.range() - right.offset()).norm(), 1e-9);
  EXPECT_GT(right.range_rest, 0.1);
  EXPECT_NEAR(biased.range_offset - kBias * biased.range_rest, right.range_offset, 1e-9);
  // What neither plane nor range bias explains is the same.
  EXPECT_NEAR(biased.constant - std::pow(biased.range_offset, 2),
              right.constant - std::pow(right.range_offset, 2),
              1e-9);
}

}  // namespace
}  // namespace plumbline
