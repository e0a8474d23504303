#include "factors/util/simd.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace plumbline {
namespace {

TEST(Simd, GoByElement) {
  std::array<double, kSimdWidth + 1> from;
  for (int k = 0; k <= kSimdWidth; ++k) from[static_cast<size_t>(k)] = 1.0 + k * k;
  const Simd loaded = LoadSimd(&from[1]);  // wherever numbers lie
  const Simd index = MakeSimd([](int k) { return k; });
  std::array<double, kSimdWidth + 1> to;
  StoreSimd(2.0 * loaded - index, &to[1]);
  double sum = 0.0;
  for (int k = 0; k < kSimdWidth; ++k) {
    const double expected = 2.0 * (1.0 + (k + 1) * (k + 1)) - k;
    EXPECT_EQ(to[static_cast<size_t>(k + 1)], expected);
    sum += expected;
  }
  EXPECT_EQ(SumOf(2.0 * loaded - index), sum);
}

// A beam without a return has a range that is not a number: it may pass no test.
TEST(Simd, SmallerIsNoNumberWhereTheSecondIsNone) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const Simd one = Simd{} + 1.0;
  const Simd two = Simd{} + 2.0;
  const Simd missing = MakeSimd([&](int k) { return k == 0 ? none : 0.5; });
  EXPECT_EQ(SumOf(Smaller(one, two)), kSimdWidth);
  EXPECT_EQ(SumOf(Smaller(two, one)), kSimdWidth);
  EXPECT_TRUE(std::isnan(Smaller(one, missing)[0]));
  EXPECT_EQ(Smaller(one, missing)[kSimdWidth - 1], 0.5);
}

}  // namespace
}  // namespace plumbline
