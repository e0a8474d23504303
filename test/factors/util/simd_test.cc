#include "factors/util/simd.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace plumbline {
namespace {

TEST(Lanes, GoByElement) {
  std::array<double, kLanes + 1> from;
  for (int k = 0; k <= kLanes; ++k) from[static_cast<size_t>(k)] = 1.0 + k * k;
  const Lanes loaded = LoadLanes(&from[1]);  // wherever numbers lie
  const Lanes index = MakeLanes([](int k) { return k; });
  std::array<double, kLanes + 1> to;
  StoreLanes(2.0 * loaded - index, &to[1]);
  double sum = 0.0;
  for (int k = 0; k < kLanes; ++k) {
    const double expected = 2.0 * (1.0 + (k + 1) * (k + 1)) - k;
    EXPECT_EQ(to[static_cast<size_t>(k + 1)], expected);
    sum += expected;
  }
  EXPECT_EQ(SumOf(2.0 * loaded - index), sum);
}

// A beam without a return has a range that is not a number: it may pass no test.
TEST(Lanes, SmallerIsNoNumberWhereTheSecondIsNone) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const Lanes one = Lanes{} + 1.0;
  const Lanes two = Lanes{} + 2.0;
  const Lanes missing = MakeLanes([&](int k) { return k == 0 ? none : 0.5; });
  EXPECT_EQ(SumOf(Smaller(one, two)), kLanes);
  EXPECT_EQ(SumOf(Smaller(two, one)), kLanes);
  EXPECT_TRUE(std::isnan(Smaller(one, missing)[0]));
  EXPECT_EQ(Smaller(one, missing)[kLanes - 1], 0.5);
}

}  // namespace
}  // namespace plumbline
