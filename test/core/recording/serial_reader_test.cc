#include "core/recording/serial_reader.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/recording/ros_messages.h"
#include "test/core/recording/cdr_text.h"

namespace plumbline {
namespace {

CdrText LaserScanText(bool is_big_endian) {
  CdrText text(is_big_endian);
  text.Add(int32_t{1'600'000'000}).Add(uint32_t{5}).Add(std::string("laser"));
  for (const float number : {-0.5f, 0.5f, 0.25f, 0.001f, 0.1f, 0.125f, 30.0f}) {
    text.Add(number);
  }
  text.Add(uint32_t{2}).Add(1.5f).Add(2.5f);
  text.Add(uint32_t{1}).Add(100.0f);
  return text;
}

class CdrTest : public ::testing::TestWithParam<bool> {};

TEST_P(CdrTest, LaserScanInEitherByteOrder) {
  const CdrText text = LaserScanText(GetParam());
  SerialReader reader;
  ASSERT_TRUE(SerialReader::ForCdr(text.view(), &reader));
  ScanLineMessage scan;
  ASSERT_TRUE(ReadLaserScan(reader, true, &scan));
  EXPECT_EQ(scan.stamp_ns, 1'600'000'000'000'000'005);
  EXPECT_EQ(scan.frame_id, "laser");
  EXPECT_EQ(scan.angle_min, -0.5f);
  EXPECT_EQ(scan.angle_increment, 0.25f);
  EXPECT_EQ(scan.time_increment, 0.001f);
  EXPECT_EQ(scan.range_min, 0.125f);
  EXPECT_EQ(scan.range_max, 30.0f);
  EXPECT_EQ(scan.ranges, (std::vector<float>{1.5f, 2.5f}));
}

TEST_P(CdrTest, OdometryInEitherByteOrder) {
  CdrText text(GetParam());
  text.Add(int32_t{7}).Add(uint32_t{0}).Add(std::string("odom")).Add(std::string("base"));
  for (const double number : {1.0, 2.0, 3.0, 0.0, 0.0, std::sin(0.5), std::cos(0.5)}) {
    text.Add(number);
  }
  for (int i = 0; i < 36; ++i) text.Add(0.0);
  for (const double number : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6}) text.Add(number);
  for (int i = 0; i < 36; ++i) text.Add(0.0);
  SerialReader reader;
  ASSERT_TRUE(SerialReader::ForCdr(text.view(), &reader));
  OdometryMessage odometry;
  ASSERT_TRUE(ReadOdometry(reader, &odometry));
  EXPECT_EQ(odometry.frame_id, "odom");
  EXPECT_EQ(odometry.child_frame_id, "base");
  EXPECT_EQ(odometry.position, (std::array<double, 3>{1.0, 2.0, 3.0}));
  EXPECT_NEAR(odometry.Yaw(), 1.0, 1e-12);
  EXPECT_EQ(odometry.angular_velocity[2], 0.6);
}

TEST_P(CdrTest, TransformsInEitherByteOrder) {
  CdrText text(GetParam());
  text.Add(uint32_t{2});
  for (const char* child : {"left", "right"}) {
    text.Add(uint32_t{5})
        .Add(uint32_t{6})
        .Add(std::string("base_link"))
        .Add(std::string(child));
    for (const double number : {1.0, 2.0, 3.0, 0.0, 0.0, 0.6, 0.8}) text.Add(number);
  }
  SerialReader reader;
  ASSERT_TRUE(SerialReader::ForCdr(text.view(), &reader));
  std::vector<Transform> transforms;
  ASSERT_TRUE(ReadTransforms(reader, &transforms));
  ASSERT_EQ(transforms.size(), 2u);
  EXPECT_EQ(transforms[1].parent, "base_link");
  EXPECT_EQ(transforms[1].child, "right");
  EXPECT_EQ(transforms[1].translation[2], 3.0);
  EXPECT_EQ(transforms[1].rotation[3], 0.8);
  ASSERT_TRUE(SerialReader::ForCdr({text.view().data, text.view().size - 16}, &reader));
  EXPECT_FALSE(ReadTransforms(reader, &transforms));
}

INSTANTIATE_TEST_SUITE_P(ByteOrders, CdrTest, ::testing::Bool());

TEST(SerialReaderTest, MessageThatBreaksOffIsNotRead) {
  const CdrText text = LaserScanText(false);
  for (size_t size = 0; size < text.view().size; ++size) {
    SerialReader reader;
    ScanLineMessage scan;
    const bool is_read = SerialReader::ForCdr({text.view().data, size}, &reader) &&
                         ReadLaserScan(reader, true, &scan);
    EXPECT_FALSE(is_read) << size;
  }
}

TEST(SerialReaderTest, WhatIsNoPlainCdrIsRefused) {
  SerialReader reader;
  for (const auto& head : {std::array<uint8_t, 4>{0, 2, 0, 0}, {0, 3, 0, 0}, {1, 1, 0, 0}}) {
    EXPECT_FALSE(SerialReader::ForCdr({head.data(), head.size()}, &reader));
  }
}

TEST(SerialReaderTest, HugeListsCostNoMemory) {
  CdrText text(false);
  text.Add(uint32_t{0xffffffff});
  SerialReader reader;
  ASSERT_TRUE(SerialReader::ForCdr(text.view(), &reader));
  uint32_t count = 0;
  std::vector<float> floats;
  EXPECT_FALSE(reader.TakeFloats(&count, &floats));
  EXPECT_EQ(floats.capacity(), 0u);
}

}  // namespace
}  // namespace plumbline
