#include "core/judging/degeneracy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test/core/judging/corridor.h"
#include "test/core/judging/hand_made_map.h"

namespace plumbline {
namespace {

class CorridorTest : public testing::Test {
 protected:
  std::vector<DegenerateInterval> Find() {
    return DegenerateIntervals(StrengthOverTime(map_.rig(), true, map_.state(), 0));
  }

  HandMadeMap map_;
  Corridor corridor_{&map_};
};

TEST_F(CorridorTest, IsOpenAlongItselfWithoutAnEnd) {
  for (int second = 0; second < 6; ++second) corridor_.See(second, second < 2);
  const std::vector<DegenerateInterval> intervals = Find();
  ASSERT_EQ(intervals.size(), 1u);
  EXPECT_EQ(intervals[0].start_s, 2.0);
  EXPECT_EQ(intervals[0].end_s, 6.0);
  EXPECT_EQ(intervals[0].direction, "horizontal, 0 deg from the x axis");
  EXPECT_GT(intervals[0].stddev_m, 1.0);
}

TEST_F(CorridorTest, StatesWhatASecondMeasures) {
  corridor_.See(0, true);
  const PositionStrength strength =
      StrengthOverTime(map_.rig(), true, map_.state(), 0).front();
  EXPECT_EQ(strength.num_segments, 30);
  // Ten segments on the end wall, each to 2 mm; seen ten metres away, what is open of the
  // heading adds next to nothing along its normal.
  EXPECT_NEAR(std::abs(strength.direction_world.x()), 1.0, 1e-3);
  EXPECT_NEAR(strength.stddev_m, 0.002 / std::sqrt(10.0), 5e-5);
}

TEST(DirectionInWordsTest, TakesEitherSense) {
  EXPECT_EQ(DirectionInWords({0.1, 0.0, -0.99}), "vertical");
  EXPECT_EQ(DirectionInWords({0.0, 1.0, 0.1}), "horizontal, 90 deg from the x axis");
  EXPECT_EQ(DirectionInWords({0.0, -1.0, 0.1}), "horizontal, 90 deg from the x axis");
}

}  // namespace
}  // namespace plumbline
