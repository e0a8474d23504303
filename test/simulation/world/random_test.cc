#include "simulation/world/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

constexpr int kCount = 200000;

TEST(Random, SameKeySameSequence) {
  Random a({1, 2, 3});
  Random b({1, 2, 3});
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.Gaussian(), b.Gaussian());
}

TEST(Random, NeighbouringKeysAreUncorrelated) {
  double sum = 0.0;
  for (uint64_t key = 0; key < kCount; ++key) {
    sum += Random({7, 0, key}).Gaussian() * Random({7, 1, key}).Gaussian();
  }
  // The mean of products of independent normal numbers has the deviation 1 / sqrt(n).
  EXPECT_LT(std::abs(sum / kCount), 4.0 / std::sqrt(kCount));
}

TEST(Random, GaussianMoments) {
  Random random({42});
  double sum = 0.0, square = 0.0, fourth = 0.0;
  int beyond_two = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.Gaussian();
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
    beyond_two += std::abs(x) > 2.0;
  }
  // Four standard deviations of each statistic: variances 1, 2, 96 and p (1 - p).
  const double four = 4.0 / std::sqrt(kCount);
  EXPECT_LT(std::abs(sum / kCount), four);
  EXPECT_LT(std::abs(square / kCount - 1.0), four * std::sqrt(2.0));
  EXPECT_LT(std::abs(fourth / kCount - 3.0), four * std::sqrt(96.0));
  const double share = std::erfc(2.0 / std::sqrt(2.0));
  EXPECT_LT(std::abs(beyond_two / static_cast<double>(kCount) - share),
            four * std::sqrt(share * (1 - share)));
}

TEST(Random, UniformStaysInRange) {
  Random random({5});
  double sum = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.Uniform();
    ASSERT_GE(x, 0.0);
    ASSERT_LT(x, 1.0);
    sum += x;
  }
  EXPECT_LT(std::abs(sum / kCount - 0.5), 4.0 / std::sqrt(12.0 * kCount));
}

}  // namespace
}  // namespace plumbline
