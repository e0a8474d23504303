#include "core/judging/words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(WordsTest, Numbers) {
  EXPECT_EQ(Decimal(1.25, 1), "1.2");
  EXPECT_EQ(Decimal(-0.001, 1), "0.0");
  EXPECT_EQ(Decimal(-0.1, 1), "-0.1");
  EXPECT_EQ(PercentOf(0.123), "12 %");
  EXPECT_EQ(PercentOf(0.004), "0.4 %");
  EXPECT_EQ(PercentOf(0.0), "0 %");
}

TEST(WordsTest, Lists) {
  EXPECT_EQ(Enumerate({}), "");
  EXPECT_EQ(Enumerate({"a"}), "a");
  EXPECT_EQ(Enumerate({"a", "b", "c"}), "a, b and c");
}

TEST(WordsTest, Spans) {
  EXPECT_EQ(SpansInWords({1, 2, 4}, 1), "from 1 to 3 s, from 4 to 5 s");
  EXPECT_EQ(SpansInWords({1, 2, 4}, 2), "from 1 to 3 s");
  EXPECT_EQ(SpansInWords({1}, 2), "");
  EXPECT_EQ(SpansInWords({}, 1), "");
  std::vector<int64_t> many;
  for (int64_t i = 0; i < 8; ++i) many.push_back(2 * i);
  EXPECT_THAT(SpansInWords(many, 1), testing::EndsWith(", from 10 to 11 s and 2 more"));
}

}  // namespace
}  // namespace plumbline
