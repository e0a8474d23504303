#include "core/outputs/point_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

namespace plumbline {
namespace {

MapPoint PointAt(double time_s, int scanner, int plane_id, float residual_m) {
  MapPoint point;
  point.time_s = time_s;
  point.scanner = scanner;
  point.plane_id = plane_id;
  point.residual_m = residual_m;
  return point;
}

int64_t NumInHistogram(const PointStatistics& statistics) {
  const auto& histogram = statistics.histogram();
  return std::accumulate(histogram.begin(), histogram.end(), int64_t{0});
}

TEST(PointStatisticsTest, GroupsAreScannersAndSeconds) {
  PointStatistics statistics;
  EXPECT_TRUE(statistics.by_second().empty());
  statistics.Add(PointAt(0.999, 1, 4, 0.25f));
  statistics.Add(PointAt(3.0, 1, 4, -0.5f));
  statistics.Add(PointAt(3.5, 0, -1, std::numeric_limits<float>::quiet_NaN()));
  ASSERT_EQ(statistics.by_second().size(), 4u);
  ASSERT_EQ(statistics.by_scanner().size(), 2u);
  EXPECT_EQ(statistics.by_second()[0].points, 1);
  EXPECT_EQ(statistics.by_second()[1].points, 0);
  EXPECT_EQ(statistics.by_second()[3].points, 2);
  EXPECT_EQ(statistics.by_second()[3].on_planes, 1);
  EXPECT_EQ(statistics.by_second()[3].sum_squares_m2, 0.25);
  EXPECT_EQ(statistics.by_scanner()[0].on_planes, 0);
  EXPECT_EQ(statistics.by_scanner()[0].sum_squares_m2, 0.0);
  EXPECT_EQ(statistics.by_scanner()[1].points, 2);
  EXPECT_EQ(statistics.by_scanner()[1].sum_squares_m2, 0.0625 + 0.25);
}

// Rounding may put the first beam before the first scan line.
TEST(PointStatisticsTest, TimeBeforeTheStartIsTheFirstSecond) {
  PointStatistics statistics;
  statistics.Add(PointAt(-0.001, 0, 1, 0.0f));
  ASSERT_EQ(statistics.by_second().size(), 1u);
  EXPECT_EQ(statistics.by_second()[0].points, 1);
}

TEST(PointStatisticsTest, HistogramHasBinsOfAMillimetre) {
  PointStatistics statistics;
  constexpr size_t kZero = PointStatistics::kBinsPerSide;
  statistics.Add(PointAt(0.0, 0, 1, 0.0f));
  statistics.Add(PointAt(0.0, 0, 1, 0.0009f));
  statistics.Add(PointAt(0.0, 0, 1, -0.0001f));
  statistics.Add(PointAt(0.0, 0, 1, 0.0995f));
  EXPECT_EQ(statistics.histogram()[kZero], 2);
  EXPECT_EQ(statistics.histogram()[kZero - 1], 1);
  EXPECT_EQ(statistics.histogram()[kZero + 99], 1);
  EXPECT_EQ(NumInHistogram(statistics), 4);
}

TEST(PointStatisticsTest, WhatIsBeyondCountsInTheOutermostBins) {
  PointStatistics statistics;
  for (const float residual_m : {0.3f, 1e6f, -0.3f, -0.2501f, 0.2499f}) {
    statistics.Add(PointAt(0.0, 0, 1, residual_m));
  }
  EXPECT_EQ(statistics.histogram().front(), 2);
  EXPECT_EQ(statistics.histogram().back(), 3);
}

TEST(PointStatisticsTest, PointsOnNoPlaneAndResidualsThatAreNoNumberAreInNoBin) {
  PointStatistics statistics;
  statistics.Add(PointAt(0.0, 0, -1, 0.001f));
  statistics.Add(PointAt(0.0, 0, kMovingPlaneId, 0.001f));
  statistics.Add(PointAt(0.0, 0, 1, std::numeric_limits<float>::infinity()));
  EXPECT_EQ(NumInHistogram(statistics), 0);
  EXPECT_EQ(statistics.by_scanner()[0].points, 3);
}

}  // namespace
}  // namespace plumbline
