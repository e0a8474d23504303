#include "core/util/date.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(FormatDate, IsInUtcAndCutsOffFractions) {
  EXPECT_EQ(FormatDate(0), "1970-01-01 00:00:00 UTC");
  EXPECT_EQ(FormatDate(1'400'000'000'999'999'999), "2014-05-13 16:53:20 UTC");
}

TEST(FormatDate, KnowsLeapDays) {
  EXPECT_EQ(FormatDate(951'868'799'000'000'000), "2000-02-29 23:59:59 UTC");
}

}  // namespace
}  // namespace plumbline
