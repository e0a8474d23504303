#include "core/recording/decode.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "test/core/recording/byte_text.h"
#include "test/core/recording/carmen_text.h"
#include "test/core/recording/cdr_text.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;

RecordingTopic TopicOf(MessageEncoding encoding,
                       const std::string& type,
                       const std::string& definition = "") {
  RecordingTopic topic;
  topic.encoding = encoding;
  topic.type = type;
  topic.definition = definition;
  topic.kind = KindOf(topic);
  return topic;
}

TEST(KindOfTest, TypesHaveTheSameNamesInBothRos) {
  for (const MessageEncoding encoding : {MessageEncoding::kRos1, MessageEncoding::kCdr}) {
    EXPECT_EQ(TopicOf(encoding, "sensor_msgs/LaserScan").kind, MessageKind::kLaserScan);
    EXPECT_EQ(TopicOf(encoding, "sensor_msgs/msg/LaserScan").kind, MessageKind::kLaserScan);
    EXPECT_EQ(TopicOf(encoding, "nav_msgs/msg/Odometry").kind, MessageKind::kOdometry);
    EXPECT_EQ(TopicOf(encoding, "tf2_msgs/msg/TFMessage").kind, MessageKind::kTransforms);
    EXPECT_EQ(TopicOf(encoding, "std_msgs/msg/String").kind, MessageKind::kOther);
    EXPECT_EQ(TopicOf(encoding, "my_msgs/msg/LaserScan").kind, MessageKind::kOther);
  }
}

TEST(KindOfTest, Ros1DefinitionMustBeTheKnownOne) {
  const char kDefinition[] = "90c7ef2dc6895d81024acba2ac42f369";
  const char kType[] = "sensor_msgs/LaserScan";
  EXPECT_EQ(TopicOf(MessageEncoding::kRos1, kType, kDefinition).kind, MessageKind::kLaserScan);
  EXPECT_EQ(TopicOf(MessageEncoding::kRos1, kType, "another").kind, MessageKind::kOther);
}

TEST(KindOfTest, EncodingDecidesWhatATypeMeans) {
  EXPECT_EQ(TopicOf(MessageEncoding::kUnknown, "sensor_msgs/LaserScan").kind,
            MessageKind::kOther);
  EXPECT_EQ(TopicOf(MessageEncoding::kCarmen, "FLASER").kind, MessageKind::kLaserScan);
  EXPECT_EQ(TopicOf(MessageEncoding::kCarmen, "sensor_msgs/LaserScan").kind,
            MessageKind::kOther);
  EXPECT_EQ(TopicOf(MessageEncoding::kRos1, "FLASER").kind, MessageKind::kOther);
}

TEST(DecodeTest, NumberIsAJointAtItsReceipt) {
  CdrText cdr(false);
  cdr.Add(0.75);
  const std::string ros1 = BytesOf(0.75);
  const std::string type = "std_msgs/msg/Float64";
  for (const bool is_cdr : {true, false}) {
    const RecordingTopic topic =
        TopicOf(is_cdr ? MessageEncoding::kCdr : MessageEncoding::kRos1, type);
    const ByteView data = is_cdr ? cdr.view() : ViewOf(ros1);
    JointMessage joints;
    ASSERT_TRUE(DecodeJoints(topic, data, 123, &joints));
    EXPECT_EQ(joints.stamp_ns, 123);
    EXPECT_THAT(joints.names, ElementsAre(""));
    EXPECT_THAT(joints.positions, ElementsAre(0.75));
    EXPECT_FALSE(DecodeJoints(topic, {data.data, data.size - 1}, 123, &joints));
  }
}

TEST(DecodeTest, JointStateHasAStampOfItsOwn) {
  CdrText cdr(true);
  cdr.Add(int32_t{5}).Add(uint32_t{7}).Add(std::string("base"));
  cdr.Add(uint32_t{2}).Add(std::string("tilt")).Add(std::string("pan"));
  cdr.Add(uint32_t{2}).Add(0.25).Add(-0.5).Add(uint32_t{0}).Add(uint32_t{0});
  JointMessage joints;
  ASSERT_TRUE(DecodeJoints(
      TopicOf(MessageEncoding::kCdr, "sensor_msgs/msg/JointState"), cdr.view(), 123, &joints));
  EXPECT_EQ(joints.stamp_ns, 5'000'000'007);
  EXPECT_THAT(joints.names, ElementsAre("tilt", "pan"));
  EXPECT_THAT(joints.positions, ElementsAre(0.25, -0.5));
}

// A message that was decoded before leaves nothing of itself.
TEST(DecodeTest, CarmenLinesAreScanLinesAndOdometry) {
  const std::string line = FlaserLine(180, "12.5");
  const RecordingTopic topic = TopicOf(MessageEncoding::kCarmen, "FLASER");
  ScanLineMessage scan;
  scan.ranges = {1.0f};
  scan.angles = {2.0f};
  scan.is_planar = false;
  ASSERT_TRUE(DecodeScanLine(topic, ViewOf(line), false, &scan));
  EXPECT_TRUE(scan.ranges.empty());
  EXPECT_TRUE(scan.angles.empty());
  EXPECT_TRUE(scan.is_planar);
  ASSERT_TRUE(DecodeScanLine(topic, ViewOf(line), true, &scan));
  EXPECT_EQ(scan.ranges.size(), 180u);
  OdometryMessage odometry;
  ASSERT_TRUE(DecodeOdometry(topic, ViewOf(line), &odometry));
  EXPECT_EQ(odometry.position[0], 0.1);
}

TEST(DecodeTest, WhatIsNotSerialisedByRosHasNoRosMessages) {
  const std::string line = FlaserLine(180, "12.5");
  for (const MessageEncoding encoding :
       {MessageEncoding::kCarmen, MessageEncoding::kUnknown}) {
    const RecordingTopic topic = TopicOf(encoding, "FLASER");
    ImuMessage imu;
    JointMessage joints;
    ImageMessage image;
    CameraInfoMessage info;
    std::vector<Transform> transforms;
    EXPECT_FALSE(DecodeImu(topic, ViewOf(line), &imu));
    EXPECT_FALSE(DecodeJoints(topic, ViewOf(line), 0, &joints));
    EXPECT_FALSE(DecodeImage(topic, ViewOf(line), &image));
    EXPECT_FALSE(DecodeCameraInfo(topic, ViewOf(line), &info));
    EXPECT_FALSE(DecodeTransforms(topic, ViewOf(line), &transforms));
  }
}

TEST(DecodeTest, TopicOfAnotherKindHasNoScanLines) {
  CdrText cdr(false);
  cdr.Add(0.75);
  ScanLineMessage scan;
  for (const char* type : {"std_msgs/msg/Float64", "std_msgs/msg/String"}) {
    EXPECT_FALSE(
        DecodeScanLine(TopicOf(MessageEncoding::kCdr, type), cdr.view(), true, &scan));
  }
}

}  // namespace
}  // namespace plumbline
