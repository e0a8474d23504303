#include "core/util/quantiles.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

TEST(TwoSidedNormalQuantile, InvertsTheTailProbability) {
  for (const double probability : {0.9999, 0.5, 0.05, 1e-4, 1e-7, 1e-20, 1e-290}) {
    const double x = TwoSidedNormalQuantile(probability);
    EXPECT_NEAR(std::erfc(x * M_SQRT1_2) / probability, 1.0, 1e-12) << probability;
  }
  EXPECT_EQ(TwoSidedNormalQuantile(1.0), 0.0);
  EXPECT_GT(TwoSidedNormalQuantile(0.0), 36.0);
}

}  // namespace
}  // namespace plumbline
