#include "core/sensor/odometry_collector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

using ::testing::IsEmpty;

constexpr int64_t kStartNs = 1'000'000'000;
constexpr int64_t kPeriodNs = 100'000'000;

// A body that drives ahead at 0.5 m/s in a direction of its wheels' frame.
OdometryMessage MessageAt(int i, double heading) {
  OdometryMessage message;
  message.stamp_ns = kStartNs + i * kPeriodNs;
  message.position = {0.05 * i * std::cos(heading), 0.05 * i * std::sin(heading), 7.0};
  message.orientation = {0.0, 0.0, std::sin(0.5 * heading), std::cos(0.5 * heading)};
  message.linear_velocity = {0.5, 0.0, 0.0};
  return message;
}

class OdometryCollectorTest : public testing::Test {
 protected:
  std::shared_ptr<const Odometry> Finish(const OdometryCollector& collector) {
    sentences_.clear();
    return collector.Finish(&sentences_);
  }

  Rig rig_;
  std::vector<std::string> sentences_;
};

TEST_F(OdometryCollectorTest, WithoutMessagesThereIsNone) {
  OdometryCollector collector(rig_);
  EXPECT_TRUE(collector.empty());
  EXPECT_EQ(collector.Fault(), "");
  EXPECT_EQ(Finish(collector), nullptr);
  EXPECT_THAT(sentences_, IsEmpty());
}

TEST_F(OdometryCollectorTest, MotionIsThatOfTheMessages) {
  OdometryCollector collector(rig_);
  for (int i = 0; i < 20; ++i) collector.Add(MessageAt(i, 2.0));
  EXPECT_FALSE(collector.empty());
  EXPECT_EQ(collector.Fault(), "");
  const std::shared_ptr<const Odometry> odometry = Finish(collector);
  ASSERT_NE(odometry, nullptr);
  EXPECT_THAT(sentences_, IsEmpty());
  EXPECT_EQ(odometry->size(), 20u);
  const auto motion = odometry->Between(kStartNs + 2 * kPeriodNs, kStartNs + 12 * kPeriodNs);
  ASSERT_TRUE(motion);
  EXPECT_NEAR(motion->translation.x(), 0.5, 1e-12);  // seen from the body, straight ahead
  EXPECT_NEAR(motion->translation.y(), 0.0, 1e-12);
  EXPECT_NEAR(motion->turn, 0.0, 1e-12);
}

TEST_F(OdometryCollectorTest, ClockIsThatOfTheScanners) {
  rig_.odometry_time_offset_s = -0.25;
  OdometryCollector collector(rig_);
  for (int i = 0; i < 20; ++i) collector.Add(MessageAt(i, 0.0));
  const std::shared_ptr<const Odometry> odometry = Finish(collector);
  ASSERT_NE(odometry, nullptr);
  EXPECT_EQ(odometry->SampleFrom(0), kStartNs - 250'000'000);
}

TEST_F(OdometryCollectorTest, MessagesWithoutOrientationAreAFault) {
  OdometryCollector collector(rig_);
  for (int i = 0; i < 5; ++i) {
    OdometryMessage message = MessageAt(i, 0.0);
    if (i == 3) message.orientation = {0.0, 0.0, 0.0, 0.0};
    if (i == 4) message.orientation[2] = std::nan("");
    collector.Add(message);
  }
  EXPECT_EQ(collector.Fault(),
            "2 of 5 messages have no orientation (their quaternion is not of length 1)");
  EXPECT_EQ(Finish(collector), nullptr);
}

TEST_F(OdometryCollectorTest, PoseThatNeverChangesIsAFault) {
  OdometryCollector collector(rig_);
  collector.Add(MessageAt(0, 1.0));
  EXPECT_EQ(collector.Fault(), "");  // one message tells nothing yet
  for (int i = 1; i < 5; ++i) {
    OdometryMessage message = MessageAt(0, 1.0);
    message.stamp_ns += i * kPeriodNs;
    collector.Add(message);
  }
  EXPECT_EQ(collector.Fault(), "its pose never changes");
  EXPECT_EQ(Finish(collector), nullptr);
  collector.Add(MessageAt(6, 1.0));
  EXPECT_EQ(collector.Fault(), "");
}

// A turn on the spot is a motion.
TEST_F(OdometryCollectorTest, TurnOnTheSpotIsNoFault) {
  OdometryCollector collector(rig_);
  for (int i = 0; i < 5; ++i) {
    OdometryMessage message = MessageAt(i, 0.1 * i);
    message.position = {1.0, 2.0, 0.0};
    message.linear_velocity = {};
    collector.Add(message);
  }
  EXPECT_EQ(collector.Fault(), "");
}

}  // namespace
}  // namespace plumbline
