#include "core/sensor/scan_header.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

ScanLineMessage MakeMessage(float time_increment) {
  ScanLineMessage message;
  message.num_beams = 271;
  message.angle_min = -2.3f;
  message.angle_increment = 0.017f;
  message.time_increment = time_increment;
  return message;
}

TEST(ScanHeaderTest, SaysInWhichUnitTimesWouldMakeSense) {
  EXPECT_THAT(WhyUnusable(MakeMessage(67000.0f)),
              HasSubstr("in nanoseconds it would take 18.157 ms (time_increment_s: 6.7e-05)"));
  EXPECT_THAT(WhyUnusable(MakeMessage(67.0f)), HasSubstr("in microseconds it would take"));
  EXPECT_THAT(WhyUnusable(MakeMessage(-1.0f)), Not(HasSubstr("it would take 1")));
}

TEST(ScanHeaderTest, SaysWhichAnglesMakeNoSense) {
  ScanLineMessage message = MakeMessage(1e-4f);
  message.angle_increment = 0.0f;
  EXPECT_EQ(WhyUnusable(message), "angle_increment is 0");
  message.angle_increment = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(WhyUnusable(message), "angle_min or angle_increment are no numbers");
  message.num_beams = 0;
  EXPECT_EQ(WhyUnusable(message), "no beams");
}

}  // namespace
}  // namespace plumbline
