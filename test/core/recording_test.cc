#include "core/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/MultiEchoLaserScan.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

#include "core/error.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int64_t kStart = 1'600'000'000'000'000'000;
constexpr int64_t kMillisecond = 1'000'000;
constexpr int64_t kPeriod = 25 * kMillisecond;

Rig MakeRig(const std::vector<std::string>& names) {
  Rig rig;
  for (const std::string& name : names) {
    Scanner scanner;
    scanner.name = name;
    scanner.topic = "/" + name + "_scan";
    rig.scanners.push_back(scanner);
  }
  return rig;
}

ScanLine MakeScanLine(int scanner_index, int64_t stamp_ns) {
  ScanLine scan_line;
  scan_line.scanner_index = scanner_index;
  scan_line.stamp_ns = stamp_ns;
  scan_line.angle_min = -0.5f;
  scan_line.angle_increment = 0.25f;
  scan_line.time_increment_s = 0.0009765625;
  scan_line.ranges = {1.0f, 2.0f, 3.0f + static_cast<float>(scanner_index), 4.0f, 5.0f};
  return scan_line;
}

sensor_msgs::LaserScan MakeMessage(int64_t stamp_ns) {
  sensor_msgs::LaserScan message;
  message.header.stamp.fromNSec(static_cast<uint64_t>(stamp_ns));
  message.angle_min = -0.5f;
  message.angle_increment = 0.25f;
  message.time_increment = 0.001f;
  message.ranges = {1.0f, 2.0f, 3.0f};
  return message;
}

std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

std::string ReadBytes(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  return bytes.str();
}

class RecordingTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "plumbline_XXXXXX").string();
    directory_ = mkdtemp(pattern.data());
    path_ = (directory_ / "recording.bag").string();
  }
  void TearDown() override { fs::remove_all(directory_); }

  // Records one message after the other, the receipt times a millisecond apart, except where
  // stamps are given as (topic, message) by the caller.
  template <typename Message>
  void Record(rosbag::Bag* bag, const std::string& topic, const Message& message) {
    receipt_ns_ += kMillisecond;
    ros::Time receipt;
    receipt.fromNSec(static_cast<uint64_t>(receipt_ns_));
    bag->write(topic, receipt, message);
  }

  // Scan lines of one scanner with these stamps in milliseconds.
  void RecordStamps(const std::vector<int>& stamps_ms) {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    for (int stamp_ms : stamps_ms) {
      Record(&bag, "/top_scan", MakeMessage(kStart + stamp_ms * kMillisecond));
    }
  }

  std::vector<ScanLine> ReadAll(RecordingReader* reader) {
    std::vector<ScanLine> scan_lines;
    ScanLine scan_line;
    while (reader->Next(&scan_line)) scan_lines.push_back(scan_line);
    return scan_lines;
  }

  std::vector<int> DeliveredStampsMs(RecordingReader* reader) {
    std::vector<int> stamps_ms;
    for (const ScanLine& scan_line : ReadAll(reader)) {
      stamps_ms.push_back(static_cast<int>((scan_line.stamp_ns - kStart) / kMillisecond));
    }
    return stamps_ms;
  }

  std::string OpenError(const std::vector<std::string>& names) {
    return ErrorOf([&] { RecordingReader reader(path_, MakeRig(names)); });
  }

  fs::path directory_;
  std::string path_;
  int64_t receipt_ns_ = kStart;
};

TEST_F(RecordingTest, DeliversWhatWasWritten) {
  const Rig rig = MakeRig({"top", "left"});
  RecordingWriter writer(path_, rig);
  std::vector<ScanLine> written;
  for (int i = 0; i < 100; ++i) {
    for (int scanner = 0; scanner < 2; ++scanner) {
      written.push_back(MakeScanLine(scanner, kStart + i * kPeriod + scanner * 7));
      writer.Write(written.back());
    }
  }
  EXPECT_FALSE(fs::exists(path_));
  writer.Close();

  RecordingReader reader(path_, rig);
  EXPECT_EQ(reader.num_scan_lines(), 200);
  EXPECT_EQ(reader.start_ns(), written.front().stamp_ns);
  EXPECT_EQ(reader.end_ns(), written.back().stamp_ns);
  EXPECT_DOUBLE_EQ(reader.scan_period_s(), 0.025);
  EXPECT_THAT(reader.warnings(), IsEmpty());
  for (int pass = 0; pass < 2; ++pass) {
    const std::vector<ScanLine> read = ReadAll(&reader);
    ASSERT_EQ(read.size(), written.size());
    for (size_t i = 0; i < read.size(); ++i) {
      EXPECT_EQ(read[i].scanner_index, written[i].scanner_index);
      EXPECT_EQ(read[i].stamp_ns, written[i].stamp_ns);
      EXPECT_EQ(read[i].angle_min, written[i].angle_min);
      EXPECT_EQ(read[i].angle_increment, written[i].angle_increment);
      EXPECT_EQ(read[i].time_increment_s, written[i].time_increment_s);
      EXPECT_EQ(read[i].ranges, written[i].ranges);
    }
    reader.Rewind();
  }
}

TEST_F(RecordingTest, WritesTheSameBytesEachTime) {
  const Rig rig = MakeRig({"top"});
  std::vector<std::string> contents;
  for (const char* name : {"a.bag", "b.bag"}) {
    RecordingWriter writer((directory_ / name).string(), rig);
    for (int i = 0; i < 20; ++i) writer.Write(MakeScanLine(0, kStart + i * kPeriod));
    writer.Close();
    contents.push_back(ReadBytes(directory_ / name));
  }
  EXPECT_GT(contents[0].size(), 20u * 5u * sizeof(float));
  EXPECT_TRUE(contents[0] == contents[1]);
}

TEST_F(RecordingTest, UnfinishedWriterLeavesNothing) {
  {
    RecordingWriter writer(path_, MakeRig({"top"}));
    writer.Write(MakeScanLine(0, kStart));
  }
  EXPECT_TRUE(fs::is_empty(directory_));
}

TEST_F(RecordingTest, WriterNamesTheFileItCanNotWrite) {
  const std::string path = (directory_ / "missing" / "recording.bag").string();
  EXPECT_THAT(ErrorOf([&] { RecordingWriter writer(path, MakeRig({"top"})); }),
              HasSubstr(path + ": can not be written"));
}

}  // namespace
}  // namespace plumbline
