#include "core/sensor/odometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/util/time.h"

namespace plumbline {
namespace {

int64_t At(double seconds) { return NanosecondsFromSeconds(seconds); }

TEST(Odometry, MotionIsSeenFromWhereItBegins) {
  // The body looks along y and goes 2 m along y and 1 m along -x, which is to its left, while
  // it turns by a quarter.
  const Odometry odometry({{At(1.0), {5.0, 5.0}, M_PI / 2}, {At(2.0), {4.0, 7.0}, M_PI}});
  const auto motion = odometry.Between(At(1.0), At(2.0));
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->translation.x(), 2.0, 1e-12);
  EXPECT_NEAR(motion->translation.y(), 1.0, 1e-12);
  EXPECT_NEAR(motion->turn, M_PI / 2, 1e-12);
}

TEST(Odometry, BetweenSamplesThePaceIsEven) {
  const Odometry odometry({{At(1.0), {0.0, 0.0}, 0.0}, {At(2.0), {1.0, 0.0}, 0.4}});
  const auto motion = odometry.Between(At(1.0), At(1.25));
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->translation.x(), 0.25, 1e-12);
  EXPECT_NEAR(motion->turn, 0.1, 1e-12);
}

TEST(Odometry, HeadingsTurnTheShortWayRound) {
  const Odometry odometry({{At(1.0), {0.0, 0.0}, 3.1}, {At(2.0), {0.0, 0.0}, -3.1}});
  EXPECT_NEAR(odometry.Between(At(1.0), At(2.0))->turn, 2.0 * M_PI - 6.2, 1e-12);
}

TEST(Odometry, SamplesComeInAnyOrderAndRepeated) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Odometry odometry({{At(3.0), {2.0, 0.0}, 0.0},
                           {At(1.0), {0.0, 0.0}, 0.0},
                           {At(2.0), {1.0, 0.0}, 0.0},
                           {At(2.0), {9.0, 0.0}, 0.0},
                           {At(2.5), {nan, 0.0}, 0.0}});
  EXPECT_EQ(odometry.size(), 3U);
  EXPECT_NEAR(odometry.Between(At(1.5), At(2.5))->translation.x(), 1.0, 1e-12);
}

TEST(Odometry, CoversNoMoreThanItsSamples) {
  EXPECT_FALSE(Odometry().Covers(At(0.0), At(1.0)));
  const Odometry odometry({{At(1.0), {0.0, 0.0}, 0.0}, {At(2.0), {1.0, 0.0}, 0.0}});
  EXPECT_TRUE(odometry.Covers(At(1.0), At(2.0)));
  EXPECT_FALSE(odometry.Covers(At(0.9), At(2.0)));
  EXPECT_FALSE(odometry.Covers(At(1.0), At(2.1)));
  EXPECT_FALSE(odometry.Between(At(1.0), At(2.1)));
}

TEST(Odometry, LongGapsAreNotBridged) {
  const double end = 2.0 + Odometry::kMaxGap + 0.1;
  const Odometry odometry({{At(1.0), {0.0, 0.0}, 0.0},
                           {At(2.0), {1.0, 0.0}, 0.0},
                           {At(end), {2.0, 0.0}, 0.0},
                           {At(end + 1.0), {3.0, 0.0}, 0.0}});
  EXPECT_TRUE(odometry.Covers(At(1.0), At(2.0)));
  EXPECT_FALSE(odometry.Covers(At(1.0), At(2.1)));
  EXPECT_FALSE(odometry.Covers(At(3.0), At(4.0)));
  EXPECT_FALSE(odometry.Covers(At(1.5), At(end + 0.5)));
  EXPECT_TRUE(odometry.Covers(At(end), At(end + 1.0)));
}

}  // namespace
}  // namespace plumbline
