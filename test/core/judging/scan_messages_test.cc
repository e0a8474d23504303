#include "core/judging/scan_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

ScanLineMessage Sent() {
  ScanLineMessage scan;
  scan.stamp_ns = 1'000'000'000;
  scan.frame_id = "laser";
  scan.angle_min = -0.5f;
  scan.angle_increment = 0.25f;
  scan.time_increment = 0.001f;
  scan.range_min = 0.125f;
  scan.range_max = 30.0f;
  scan.num_beams = 4;
  scan.ranges = {1.0f, 30.0f, 2.0f, 40.0f};
  return scan;
}

ScanMessage Take(const ScanLineMessage& sent, const Scanner* scanner = nullptr) {
  MessageRef where;
  where.receipt_ns = 1'000'500'000;
  ScanMessage message;
  TakeOver(where, sent, scanner, &message);
  return message;
}

TEST(TakeOverTest, MessageIsAScanLine) {
  const ScanMessage message = Take(Sent());
  EXPECT_EQ(message.receipt_ns, 1'000'500'000);
  EXPECT_EQ(message.frame_id, "laser");
  EXPECT_TRUE(message.usable);
  EXPECT_EQ(message.unusable_reason, "");
  EXPECT_EQ(message.stated_min_range_m, 0.125);
  EXPECT_EQ(message.stated_max_range_m, 30.0);
  EXPECT_EQ(message.line.stamp_ns, 1'000'000'000);
  EXPECT_EQ(message.line.angle_min, -0.5);
  EXPECT_EQ(message.line.angle_increment, 0.25);
  EXPECT_NEAR(message.line.time_increment_s, 0.001, 1e-9);
  EXPECT_THAT(message.line.ranges, ElementsAre(1.0f, 30.0f, 2.0f, 40.0f));
  EXPECT_EQ(message.line.angles, nullptr);
}

TEST(TakeOverTest, BeamsAtTheStatedLimitAreMarked) {
  EXPECT_THAT(Take(Sent()).is_at_stated_limit, ElementsAre(false, true, false, false));
  ScanLineMessage none = Sent();
  none.ranges[1] = 3.0f;
  EXPECT_THAT(Take(none).is_at_stated_limit, IsEmpty());
}

TEST(TakeOverTest, RigFileSaysMoreThanTheMessage) {
  Scanner scanner;
  scanner.angle_min_rad = -1.0;
  scanner.time_increment_s = 0.002;
  const ScanMessage message = Take(Sent(), &scanner);
  EXPECT_EQ(message.line.angle_min, -1.0);
  EXPECT_NEAR(message.line.time_increment_s, 0.002, 1e-9);
}

// A driver that counts against the turn: the beam that it took first comes first.
TEST(TakeOverTest, BeamsComeInTheOrderOfTheirTimes) {
  ScanLineMessage sent = Sent();
  sent.time_increment = -0.001f;
  const ScanMessage message = Take(sent);
  EXPECT_TRUE(message.usable);
  EXPECT_THAT(message.line.ranges, ElementsAre(40.0f, 2.0f, 30.0f, 1.0f));
  EXPECT_GT(message.line.time_increment_s, 0.0);
  EXPECT_NEAR(message.line.BeamAngle(0), 0.25, 1e-6);
  EXPECT_THAT(message.is_at_stated_limit, ElementsAre(false, false, true, false));
}

TEST(TakeOverTest, WhatIsNotUsableSaysWhy) {
  ScanLineMessage sent = Sent();
  sent.time_increment = 5.0f;
  const ScanMessage bad = Take(sent);
  EXPECT_FALSE(bad.usable);
  EXPECT_NE(bad.unusable_reason.find("time_increment"), std::string::npos);
  sent = Sent();
  sent.is_planar = false;
  const ScanMessage cloud = Take(sent);
  EXPECT_FALSE(cloud.usable);
  EXPECT_FALSE(cloud.is_planar);
  EXPECT_EQ(cloud.unusable_reason, "");
}

TEST(TakeOverTest, NothingIsLeftOfTheMessageBefore) {
  MessageRef where;
  ScanMessage message;
  ScanLineMessage irregular = Sent();
  irregular.angles = {-0.5f, -0.2f, 0.0f, 0.3f};
  TakeOver(where, irregular, nullptr, &message);
  ASSERT_NE(message.line.angles, nullptr);
  EXPECT_NEAR(message.line.BeamAngle(1), -0.2, 1e-6);
  ScanLineMessage regular = Sent();
  regular.ranges = {1.0f, 2.0f, 3.0f, 4.0f};
  TakeOver(where, regular, nullptr, &message);
  EXPECT_EQ(message.line.angles, nullptr);
  EXPECT_THAT(message.is_at_stated_limit, IsEmpty());
}

}  // namespace
}  // namespace plumbline
