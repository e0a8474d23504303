#include "core/recording/messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace plumbline {
namespace {

ScanLineMessage GoodScanLine() {
  ScanLineMessage scan;
  scan.angle_min = -1.5f;
  scan.angle_increment = 0.01f;
  scan.time_increment = 1e-4f;
  scan.num_beams = 300;
  return scan;
}

TEST(ScanLineMessageTest, IsUsableWhereAnglesAndTimesMakeSense) {
  EXPECT_TRUE(GoodScanLine().IsUsable());
  ScanLineMessage scan = GoodScanLine();
  scan.angle_increment = -0.01f;  // clockwise
  scan.time_increment = 0.0f;     // all at once
  EXPECT_TRUE(scan.IsUsable());
  scan.num_beams = 0;
  EXPECT_FALSE(scan.IsUsable());
}

TEST(ScanLineMessageTest, NumbersThatAreNoneAreNotUsable) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    for (float ScanLineMessage::*field : {&ScanLineMessage::angle_min,
                                          &ScanLineMessage::angle_increment,
                                          &ScanLineMessage::time_increment}) {
      ScanLineMessage scan = GoodScanLine();
      scan.*field = bad;
      EXPECT_FALSE(scan.IsUsable()) << bad;
    }
  }
  ScanLineMessage scan = GoodScanLine();
  scan.angle_increment = 0.0f;
  EXPECT_FALSE(scan.IsUsable());
  scan = GoodScanLine();
  scan.time_increment = -1e-4f;
  EXPECT_FALSE(scan.IsUsable());
}

TEST(ScanLineMessageTest, NoScanLineTakesLongerThanTwoSeconds) {
  ScanLineMessage scan = GoodScanLine();
  scan.num_beams = 2048;
  scan.time_increment = 1.0f / 1024.0f;
  EXPECT_TRUE(scan.IsUsable());
  ++scan.num_beams;
  EXPECT_FALSE(scan.IsUsable());
}

TEST(OdometryMessageTest, YawIsTheTurnAboutZ) {
  OdometryMessage odometry;
  EXPECT_EQ(odometry.Yaw(), 0.0);
  for (const double yaw : {-3.0, -1.0, 0.25, 1.5707963267948966, 3.1}) {
    odometry.orientation = {0.0, 0.0, std::sin(0.5 * yaw), std::cos(0.5 * yaw)};
    EXPECT_NEAR(odometry.Yaw(), yaw, 1e-15);
    for (double& number : odometry.orientation) number *= -1.0;  // the same rotation
    EXPECT_NEAR(odometry.Yaw(), yaw, 1e-15);
  }
}

// A robot that turns by yaw and then rolls about its own long axis still heads the same way.
TEST(OdometryMessageTest, RollLeavesYaw) {
  const double yaw = 2.5;
  for (const double roll : {-1.4, 0.3, 3.0}) {
    const double sin_yaw = std::sin(0.5 * yaw), cos_yaw = std::cos(0.5 * yaw);
    const double sin_roll = std::sin(0.5 * roll), cos_roll = std::cos(0.5 * roll);
    OdometryMessage odometry;
    odometry.orientation = {
        cos_yaw * sin_roll, sin_yaw * sin_roll, sin_yaw * cos_roll, cos_yaw * cos_roll};
    EXPECT_NEAR(odometry.Yaw(), yaw, 1e-14) << roll;
  }
}

}  // namespace
}  // namespace plumbline
