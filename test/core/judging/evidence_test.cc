#include "core/judging/evidence.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(ShareTest, IsZeroWhereNothingCouldBeCompared) {
  EXPECT_EQ((Share{0.0, 0.0}).value(), 0.0);
  EXPECT_EQ((Share{1.0, 4.0}).value(), 0.25);
}

TEST(SmoothedTest, NeighboursCountWhereThereAreAny) {
  const SharesOverTime shares = {{1.0, 10.0}, {2.0, 20.0}, {4.0, 40.0}};
  EXPECT_EQ(Smoothed(shares, 0).contradicted, 3.0);
  EXPECT_EQ(Smoothed(shares, 0).comparable, 30.0);
  EXPECT_EQ(Smoothed(shares, 1).contradicted, 7.0);
  EXPECT_EQ(Smoothed(shares, 2).comparable, 60.0);
  // Of a second behind the recording's end, the last one is a neighbour.
  EXPECT_EQ(Smoothed(shares, 3).contradicted, 4.0);
  EXPECT_EQ(Smoothed(shares, 9).comparable, 0.0);
  EXPECT_EQ(Smoothed({}, 0).comparable, 0.0);
}

TEST(IntervalsOfTest, RunsOfMarkedSecondsAreIntervals) {
  const auto intervals = IntervalsOf({true, true, false, false, false, true}, 3, "why");
  ASSERT_EQ(intervals.size(), 2u);
  EXPECT_EQ(intervals[0].start_s, 0.0);
  EXPECT_EQ(intervals[0].end_s, 2.0);
  EXPECT_EQ(intervals[1].start_s, 5.0);
  EXPECT_EQ(intervals[1].end_s, 6.0);
  EXPECT_EQ(intervals[1].reason, "why");
}

TEST(IntervalsOfTest, ShortGapsAreBridged) {
  const std::vector<bool> marked = {true, false, false, true};
  EXPECT_EQ(IntervalsOf(marked, 2, "").size(), 2u);
  const auto bridged = IntervalsOf(marked, 3, "");
  ASSERT_EQ(bridged.size(), 1u);
  EXPECT_EQ(bridged[0].end_s, 4.0);
  EXPECT_TRUE(IntervalsOf({false, false}, 3, "").empty());
  EXPECT_TRUE(IntervalsOf({}, 3, "").empty());
}

}  // namespace
}  // namespace plumbline
