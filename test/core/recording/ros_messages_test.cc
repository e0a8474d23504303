// Messages of cameras, as ROS 1 and as ROS 2 write them; the others: recording_source_test.cc.

#include "core/recording/ros_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "test/core/recording/cdr_text.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;

// Writes as ROS 1 does: without gaps, little endian.
class Ros1Text {
 public:
  template <typename Number>
  Ros1Text& Add(Number number) {
    const auto* bytes = reinterpret_cast<const uint8_t*>(&number);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof(Number));
    return *this;
  }
  Ros1Text& Add(const std::string& text) {
    Add(static_cast<uint32_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    return *this;
  }
  Ros1Text& AddBytes(const std::vector<uint8_t>& bytes) {
    Add(static_cast<uint32_t>(bytes.size()));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  ByteView view() const { return {bytes_.data(), bytes_.size()}; }
  ByteView first(size_t size) const { return {bytes_.data(), size}; }

 private:
  std::vector<uint8_t> bytes_;
};

// What follows the header: two rows of three pixels.
template <typename Text>
Text& AddImage(uint8_t is_big_endian, uint32_t row_bytes, size_t num_bytes, Text* text) {
  text->Add(uint32_t{2}).Add(uint32_t{3}).Add(std::string("16UC1")).Add(is_big_endian);
  std::vector<uint8_t> data(num_bytes);
  for (size_t i = 0; i < num_bytes; ++i) data[i] = static_cast<uint8_t>(i + 1);
  text->Add(row_bytes);
  text->AddBytes(data);
  return *text;
}

template <typename Text>
Text& AddInfo(Text* text) {
  text->Add(uint32_t{480}).Add(uint32_t{640}).Add(std::string("plumb_bob"));
  text->Add(uint32_t{2}).Add(0.25).Add(-0.5);
  for (int i = 0; i < 9; ++i) text->Add(1.0 * i);    // K
  for (int i = 0; i < 9; ++i) text->Add(-1.0);       // R
  for (int i = 0; i < 12; ++i) text->Add(10.0 * i);  // P
  for (int i = 0; i < 6; ++i) text->Add(uint32_t{0});
  return text->Add(uint8_t{1});
}

void ExpectImage(const ImageMessage& image) {
  EXPECT_EQ(image.stamp_ns, 5'000'000'007);
  EXPECT_EQ(image.frame_id, "eye");
  EXPECT_EQ(image.height, 2u);
  EXPECT_EQ(image.width, 3u);
  EXPECT_EQ(image.encoding, "16UC1");
  EXPECT_EQ(image.row_bytes, 7u);
  ASSERT_EQ(image.data.size, 14u);
  EXPECT_EQ(image.data.data[13], 14);
}

TEST(RosMessages, ImagesAreTheSameInBothRos) {
  Ros1Text ros1;
  ros1.Add(uint32_t{1}).Add(uint32_t{5}).Add(uint32_t{7}).Add(std::string("eye"));
  ImageMessage image;
  ASSERT_TRUE(ReadImage(SerialReader::ForRos1(AddImage(1, 7, 14, &ros1).view()), &image));
  ExpectImage(image);
  EXPECT_TRUE(image.is_big_endian);
  for (const bool is_big_endian : {false, true}) {
    CdrText cdr(is_big_endian);
    cdr.Add(uint32_t{5}).Add(uint32_t{7}).Add(std::string("eye"));
    SerialReader reader;
    ASSERT_TRUE(SerialReader::ForCdr(AddImage(0, 7, 14, &cdr).view(), &reader));
    ImageMessage from_cdr;
    ASSERT_TRUE(ReadImage(reader, &from_cdr));
    ExpectImage(from_cdr);
    EXPECT_FALSE(from_cdr.is_big_endian);
  }
}

TEST(RosMessages, ImagesThatAreCutOrLackRowsAreRefused) {
  Ros1Text ros1;
  ros1.Add(uint32_t{1}).Add(uint32_t{5}).Add(uint32_t{7}).Add(std::string("eye"));
  const size_t size = AddImage(0, 7, 14, &ros1).view().size;
  ImageMessage image;
  for (size_t cut = 0; cut < size; ++cut) {
    EXPECT_FALSE(ReadImage(SerialReader::ForRos1(ros1.first(cut)), &image)) << cut;
  }
  Ros1Text short_of_rows;
  short_of_rows.Add(uint32_t{1}).Add(uint32_t{5}).Add(uint32_t{7}).Add(std::string("eye"));
  EXPECT_FALSE(
      ReadImage(SerialReader::ForRos1(AddImage(0, 7, 13, &short_of_rows).view()), &image));
}

TEST(RosMessages, CameraInfosAreTheSameInBothRos) {
  const auto expect = [](const CameraInfoMessage& info) {
    EXPECT_EQ(info.height, 480u);
    EXPECT_EQ(info.width, 640u);
    EXPECT_THAT(info.distortion, ElementsAre(0.25, -0.5));
    EXPECT_EQ(info.camera[4], 4.0);
    EXPECT_EQ(info.projection[6], 60.0);
  };
  Ros1Text ros1;
  ros1.Add(uint32_t{1}).Add(uint32_t{5}).Add(uint32_t{7}).Add(std::string("eye"));
  CameraInfoMessage info;
  ASSERT_TRUE(ReadCameraInfo(SerialReader::ForRos1(AddInfo(&ros1).view()), &info));
  expect(info);
  const size_t size = ros1.view().size;
  for (size_t cut = 0; cut < size; ++cut) {
    EXPECT_FALSE(ReadCameraInfo(SerialReader::ForRos1(ros1.first(cut)), &info)) << cut;
  }
  CdrText cdr(false);
  cdr.Add(uint32_t{5}).Add(uint32_t{7}).Add(std::string("eye"));
  SerialReader reader;
  ASSERT_TRUE(SerialReader::ForCdr(AddInfo(&cdr).view(), &reader));
  CameraInfoMessage from_cdr;
  ASSERT_TRUE(ReadCameraInfo(reader, &from_cdr));
  expect(from_cdr);
}

}  // namespace
}  // namespace plumbline
