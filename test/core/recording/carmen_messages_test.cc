#include "core/recording/carmen_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "test/core/recording/byte_text.h"
#include "test/core/recording/carmen_text.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;

struct Fan {
  int num_ranges;
  double start_deg;
  double increment_deg;
};

TEST(CarmenMessagesTest, AnglesOfOldLinesFollowFromTheNumberOfRanges) {
  for (const Fan& fan : {Fan{180, -90, 1},
                         Fan{181, -90, 1},
                         Fan{360, -90, 0.5},
                         Fan{361, -90, 0.5},
                         Fan{541, -135, 0.5},
                         Fan{1081, -135, 0.25},
                         Fan{91, -90, 2}}) {
    ScanLineMessage scan;
    ASSERT_TRUE(ReadCarmenScanLine(ViewOf(FlaserLine(fan.num_ranges, "12.5")), true, &scan));
    EXPECT_EQ(scan.ranges.size(), static_cast<size_t>(fan.num_ranges));
    EXPECT_EQ(scan.ranges[7], 1.07f);
    EXPECT_NEAR(scan.angle_min, fan.start_deg * M_PI / 180, 1e-6) << fan.num_ranges;
    EXPECT_NEAR(scan.angle_increment, fan.increment_deg * M_PI / 180, 1e-7) << fan.num_ranges;
    EXPECT_EQ(scan.stamp_ns, 12'500'000'000);
    EXPECT_TRUE(scan.IsUsable());
  }
}

TEST(CarmenMessagesTest, NewLinesSayTheirAngles) {
  const std::string scanner = " 0 -1.570796 3.141593 0.017453 81.9 0.01 0 3 1.5 2.5 3.5 ";
  const std::string tail = "1077905936.123456789 host 0.5";
  ScanLineMessage scan;
  ASSERT_TRUE(
      ReadCarmenScanLine(ViewOf("RAWLASER1" + scanner + "2 10 11 " + tail), true, &scan));
  EXPECT_THAT(scan.ranges, ElementsAre(1.5f, 2.5f, 3.5f));
  EXPECT_EQ(scan.angle_min, -1.570796f);
  EXPECT_EQ(scan.angle_increment, 0.017453f);
  EXPECT_EQ(scan.range_max, 81.9f);
  EXPECT_EQ(scan.stamp_ns, 1'077'905'936'123'456'789);
  const std::string robot = "0 1 2 3 4 5 6 0.1 0.2 0.5 0.5 0.9 ";
  ASSERT_TRUE(ReadCarmenScanLine(ViewOf("ROBOTLASER1" + scanner + robot + tail), true, &scan));
  EXPECT_EQ(scan.stamp_ns, 1'077'905'936'123'456'789);
}

TEST(CarmenMessagesTest, OdometryIsRead) {
  OdometryMessage odometry;
  ASSERT_TRUE(ReadCarmenOdometry(
      ViewOf("ODOM 1.5 -2.5 -1.570796 0.4 0.1 0.0 70.1796 nohost 0.5\n"), &odometry));
  EXPECT_EQ(odometry.position[0], 1.5);
  EXPECT_EQ(odometry.position[1], -2.5);
  EXPECT_NEAR(odometry.Yaw(), -1.570796, 1e-12);
  EXPECT_EQ(odometry.linear_velocity[0], 0.4);
  EXPECT_EQ(odometry.angular_velocity[2], 0.1);
  EXPECT_EQ(odometry.stamp_ns, 70'179'600'000);
}

TEST(CarmenMessagesTest, ScanLinesStateTheRobotsPoseByOdometry) {
  const std::string tail = " 70.5 nohost 0.5";
  const std::string ranges = " 2 1.0 2.0 ";
  const std::string scanner = " 0 -1.57 3.14 1.57 81.9 0.01 0";
  const std::string laser = "7 8 9 ";
  OdometryMessage odometry;
  ASSERT_TRUE(ReadCarmenOdometry(ViewOf("FLASER" + ranges + laser + "1.5 -2.5 0.7" + tail),
                                 &odometry));
  EXPECT_EQ(odometry.position[0], 1.5);
  EXPECT_NEAR(odometry.Yaw(), 0.7, 1e-12);
  EXPECT_EQ(odometry.linear_velocity[0], 0.0);
  EXPECT_EQ(odometry.stamp_ns, 70'500'000'000);
  const std::string robot = "1.5 -2.5 0.7 -0.4 0.1 0.2 0.2 1e6";
  ASSERT_TRUE(ReadCarmenOdometry(
      ViewOf("ROBOTLASER1" + scanner + ranges + "1 99 " + laser + robot + tail), &odometry));
  EXPECT_EQ(odometry.position[1], -2.5);
  EXPECT_EQ(odometry.linear_velocity[0], -0.4);
  EXPECT_EQ(odometry.angular_velocity[2], 0.1);
  EXPECT_FALSE(
      ReadCarmenOdometry(ViewOf("FLASER" + ranges + laser + "1.5" + tail), &odometry));
  EXPECT_FALSE(CarmenScanLineHasOdometry("RAWLASER1"));
}

TEST(CarmenMessagesTest, LinesThatLackSomethingAreNotRead) {
  const std::string whole = FlaserLine(20, "12.5");
  ScanLineMessage scan;
  for (size_t size = 0; size + 2 < whole.size(); ++size) {
    // But for the last number, which has lost its last digits only.
    const bool is_read = ReadCarmenScanLine(ViewOf(whole.substr(0, size)), true, &scan);
    EXPECT_EQ(is_read, size > whole.find("nohost") + 7) << size;
  }
  for (const char* line : {"FLASER 4000000000 1.0 2.0 0 0 0 0 0 0 1 host 1",
                           "FLASER -1 1.0 0 0 0 0 0 0 1 host 1",
                           "FLASER 2 1.0 x 0 0 0 0 0 0 1 host 1",
                           "FLASER 1 1.0 0 0 0 0 0 0 1e9 host 1",
                           "FLASER 1 1.0 0 0 0 0 0 0 99999999999999 host 1",
                           "FLASER 1 1.0 0 0 0 0 0 0 -1 host 1",
                           "FLASER 1 1.0 0 0 0 0 0 0 1 host 1 more"}) {
    EXPECT_FALSE(ReadCarmenScanLine(ViewOf(line), true, &scan)) << line;
  }
}

TEST(CarmenMessagesTest, KindsAreThoseOfWholeWords) {
  EXPECT_EQ(CarmenKindOf("FLASER"), MessageKind::kLaserScan);
  EXPECT_EQ(CarmenKindOf("RAWLASER5"), MessageKind::kLaserScan);
  EXPECT_EQ(CarmenKindOf("ROBOTLASER2"), MessageKind::kLaserScan);
  EXPECT_EQ(CarmenKindOf("ODOM"), MessageKind::kOdometry);
  for (const char* word : {"", "ODOMETRY", "FLASER1", "RAWLASER6", "TRUEPOS", "odom"}) {
    EXPECT_EQ(CarmenKindOf(word), MessageKind::kOther) << word;
  }
}

TEST(CarmenMessagesTest, ReceiptIsTheLastWord) {
  int64_t receipt_ns = 0;
  ASSERT_TRUE(ReadCarmenReceipt(ViewOf("ODOM 1 2 3 70.5 host 0.250000001\r\n"), &receipt_ns));
  EXPECT_EQ(receipt_ns, 250'000'001);
  ASSERT_TRUE(ReadCarmenReceipt(ViewOf("7"), &receipt_ns));
  EXPECT_EQ(receipt_ns, 7'000'000'000);
  // Digits beyond nanoseconds have no effect.
  ASSERT_TRUE(ReadCarmenReceipt(ViewOf("SYNC 1.0000000019"), &receipt_ns));
  EXPECT_EQ(receipt_ns, 1'000'000'001);
  for (const char* line : {"", " \n", "ODOM x", "ODOM 1.5x", "ODOM -1", "ODOM .5"}) {
    EXPECT_FALSE(ReadCarmenReceipt(ViewOf(line), &receipt_ns)) << line;
  }
}

// The same fields otherwise, and a scan line that was read before leaves nothing behind.
TEST(CarmenMessagesTest, RangesAreReadOnlyWhereTheyAreWanted) {
  ScanLineMessage scan;
  scan.frame_id = "laser";
  scan.range_max = 30.0f;
  ASSERT_TRUE(ReadCarmenScanLine(ViewOf(FlaserLine(180, "12.5")), false, &scan));
  EXPECT_TRUE(scan.ranges.empty());
  EXPECT_EQ(scan.num_beams, 180u);
  EXPECT_EQ(scan.frame_id, "");
  EXPECT_EQ(scan.range_max, 0.0f);
  EXPECT_EQ(scan.stamp_ns, 12'500'000'000);
}

}  // namespace
}  // namespace plumbline
