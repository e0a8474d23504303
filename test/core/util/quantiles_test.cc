#include "core/util/quantiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

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

TEST(SampleQuantile, IsAValueOfTheSample) {
  const std::vector<double> values = {5.0, 1.0, 4.0, 2.0, 3.0};
  EXPECT_EQ(SampleQuantile(values, 0.0), 1.0);
  EXPECT_EQ(SampleQuantile(values, 0.5), 3.0);
  EXPECT_EQ(SampleQuantile(values, 0.9), 4.0);
  EXPECT_EQ(SampleQuantile(values, 1.0), 5.0);
  EXPECT_EQ(SampleQuantile(std::vector<float>(), 0.5), 0.0F);
}

TEST(Median, IsTheLargerOfTheTwoInTheMiddle) {
  EXPECT_EQ(Median(std::vector<int>{3, 1, 2}), 2);
  EXPECT_EQ(Median(std::vector<double>{4.0, 1.0, 3.0, 2.0}), 3.0);
  EXPECT_EQ(Median(std::vector<double>()), 0.0);
}

}  // namespace
}  // namespace plumbline
