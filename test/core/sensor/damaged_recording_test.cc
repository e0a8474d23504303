// Bags that are not what they claim: what can be read is read, and what is missing is told.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "core/sensor/recording.h"
#include "core/util/one_line.h"
#include "test/core/sensor/recording_fixture.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kNumScans = 16;  // of each of the two scanners

class DamagedRecordingTest : public RecordingTest {
 protected:
  // Two scanners in chunks of four scans each.
  void Write(rosbag::compression::CompressionType compression) {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    bag.setCompression(compression);
    bag.setChunkThreshold(900);
    for (int i = 0; i < kNumScans; ++i) {
      sensor_msgs::LaserScan message = MakeMessage(kStart + i * kPeriod);
      message.header.seq = static_cast<uint32_t>(i);
      message.header.frame_id = "laser";
      message.intensities = {0.5f, 0.25f, 0.125f};
      Record(&bag, "/top_scan", message);
      message.ranges.push_back(4.0f);
      Record(&bag, "/left_scan", message);
    }
    bag.close();
    bytes_ = ReadBytes(path_);
  }

  // The number at the field's value becomes `value`.
  void SetField(const std::string& name, uint32_t value, size_t from = 0) {
    const size_t position = bytes_.find(name + "=", from) + name.size() + 1;
    bytes_.replace(position, 4, reinterpret_cast<const char*>(&value), 4);
  }

  void WriteDamaged() { WriteBytes(path_, bytes_); }

  RecordingReader Open() { return RecordingReader(path_, rig_); }

  Rig rig_ = MakeRig({"top", "left"});
  std::string bytes_;
};

TEST_F(DamagedRecordingTest, GoodBagsAreReadInSilence) {
  for (const auto compression : {rosbag::compression::Uncompressed,
                                 rosbag::compression::BZ2,
                                 rosbag::compression::LZ4}) {
    Write(compression);
    RecordingReader reader = Open();
    EXPECT_EQ(reader.num_scan_lines(), 2 * kNumScans);
    EXPECT_THAT(reader.warnings(), IsEmpty());
    EXPECT_EQ(ReadAll(&reader)[3].ranges, (std::vector<float>{1.0f, 2.0f, 3.0f, 4.0f}));
  }
}

TEST_F(DamagedRecordingTest, NumberOfChunksThatIsTooLowLosesNothing) {
  Write(rosbag::compression::Uncompressed);
  SetField("chunk_count", 1);
  WriteDamaged();
  RecordingReader reader = Open();
  EXPECT_EQ(reader.num_scan_lines(), 2 * kNumScans);
  EXPECT_THAT(reader.warnings(),
              ElementsAre(HasSubstr("the header of the bag states 1 chunk, but ")));
}

TEST_F(DamagedRecordingTest, BagThatWasNeverClosedIsRead) {
  for (const auto compression : {rosbag::compression::Uncompressed,
                                 rosbag::compression::BZ2,
                                 rosbag::compression::LZ4}) {
    Write(compression);
    const size_t index_position =
        *reinterpret_cast<const uint64_t*>(bytes_.data() + bytes_.find("index_pos=") + 10);
    SetField("index_pos", 0);
    SetField("chunk_count", 0);
    SetField("conn_count", 0);
    bytes_.resize(index_position);
    WriteDamaged();
    RecordingReader reader = Open();
    EXPECT_EQ(reader.num_scan_lines(), 2 * kNumScans);
    EXPECT_THAT(reader.warnings(),
                ElementsAre(HasSubstr("the bag was never closed and has no index")));
  }
}

// A recorder that is killed leaves its last chunk without a length.
TEST_F(DamagedRecordingTest, ChunkThatWasBeingWrittenIsRead) {
  Write(rosbag::compression::Uncompressed);
  SetField("index_pos", 0);
  const size_t chunk = bytes_.rfind("compression=none") - 4;
  const uint32_t header_length = *reinterpret_cast<const uint32_t*>(bytes_.data() + chunk - 4);
  const size_t data = chunk + header_length + 4;
  const uint32_t length = *reinterpret_cast<const uint32_t*>(bytes_.data() + data - 4);
  bytes_.replace(data - 4, 4, std::string(4, '\0'));
  SetField("size", 0, chunk);
  bytes_.resize(data + length - 30);
  WriteDamaged();
  RecordingReader reader = Open();
  EXPECT_EQ(reader.num_scan_lines(), 2 * kNumScans - 1);
  EXPECT_THAT(reader.warnings(),
              Contains(HasSubstr("what is no message was passed over in a chunk")));
}

TEST_F(DamagedRecordingTest, TruncatedBagIsReadAsFarAsItGoes) {
  for (const auto compression : {rosbag::compression::Uncompressed,
                                 rosbag::compression::BZ2,
                                 rosbag::compression::LZ4}) {
    Write(compression);
    const std::string whole = bytes_;
    int last = 2 * kNumScans;
    for (size_t size = whole.size() - 1; size > 4200; size -= 97) {
      bytes_ = whole.substr(0, size);
      WriteDamaged();
      std::string error;
      int num_read = 0;
      try {
        RecordingReader reader = Open();
        num_read = reader.num_scan_lines();
        EXPECT_THAT(reader.warnings(), Not(IsEmpty())) << size;
      } catch (const Error& caught) {
        error = caught.what();
        EXPECT_THAT(error, HasSubstr(path_ + ": has no ")) << size;
      }
      EXPECT_LE(num_read, last) << "less of the bag, more scan lines";
      last = num_read;
    }
  }
  fs::resize_file(path_, 4000);
  EXPECT_THAT(OpenError({"top"}), HasSubstr(path_ + ": the recording breaks off in its head"));
  fs::resize_file(path_, 13);
  EXPECT_THAT(OpenError({"top"}), HasSubstr(path_ + ": the recording breaks off in its head"));
}

TEST_F(DamagedRecordingTest, CountsTheMessageThatCanNotBeDecoded) {
  RecordStamps({0, 25, 50});
  bytes_ = ReadBytes(path_);
  // The number of ranges of the second message: 3 becomes 1000.
  const float ranges[] = {1.0f, 2.0f, 3.0f};
  const std::string pattern(reinterpret_cast<const char*>(ranges), sizeof(ranges));
  const size_t position = bytes_.rfind(pattern, bytes_.rfind(pattern) - 1) - 4;
  ASSERT_EQ(bytes_[position], 3);
  bytes_.replace(position, 2, "\xe8\x03");
  WriteDamaged();
  RecordingReader reader(path_, MakeRig({"top"}));
  EXPECT_THAT(DeliveredStampsMs(&reader), ElementsAre(0, 50));
  EXPECT_THAT(reader.warnings(),
              ElementsAre("scanner 'top': 1 message is lost that can not be decoded, the "
                          "first recorded at 1600000000.002000000 s"));
}

TEST_F(DamagedRecordingTest, PackedChunkThatIsDamagedCostsItsScanLines) {
  for (const auto compression : {rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    Write(compression);
    const size_t chunk = bytes_.rfind("compression=", bytes_.rfind("compression=") - 1);
    for (size_t i = 0; i < 8; ++i) bytes_[chunk + 120 + i] ^= '\x55';
    WriteDamaged();
    RecordingReader reader = Open();
    EXPECT_LT(reader.num_scan_lines(), 2 * kNumScans);
    EXPECT_GE(reader.num_scan_lines(), kNumScans);
    EXPECT_THAT(reader.warnings(),
                AllOf(Contains(HasSubstr("a chunk can not be read whole")),
                      Contains(HasSubstr("topic /top_scan: the index of the bag states 16 "
                                         "messages, but "))));
  }
}

TEST_F(DamagedRecordingTest, MessageOfAnotherTopicIsMissed) {
  Write(rosbag::compression::Uncompressed);
  // A message's topic number in its header is followed by the field op.
  const std::string pattern("conn=\0\0\0\0\4\0\0\0op=\2", 17);
  const size_t position = bytes_.find(pattern);
  ASSERT_NE(position, std::string::npos);
  bytes_[position + 5] = 77;
  WriteDamaged();
  RecordingReader reader = Open();
  EXPECT_EQ(reader.num_scan_lines(), 2 * kNumScans - 1);
  EXPECT_THAT(reader.warnings(),
              ElementsAre(HasSubstr("topic /top_scan: the index of the bag states 16 "
                                    "messages, but 15 could be found"),
                          HasSubstr("a message belongs to no topic and is lost: at byte ")));
}

TEST_F(DamagedRecordingTest, ErrorsAndWarningsStayOnOneLine) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    Record(&bag, "/a\nb\x1b[2J\xff", MakeMessage(kStart));
    Record(&bag, "/" + std::string(100'000, 'x'), MakeMessage(kStart));
    for (int i = 0; i < 50; ++i) {
      Record(&bag, "/topic" + std::to_string(i), MakeMessage(kStart));
    }
  }
  const std::string error = OpenError({"top"});
  EXPECT_EQ(error.find('\n'), std::string::npos);
  EXPECT_THAT(error, AllOf(HasSubstr("/a\\nb\\x1b[2J\\xff"), HasSubstr(" and 32 more")));
  EXPECT_LT(error.size(), 2000u);
}

// One byte changed anywhere, or the end cut off: an Error on one line that names the file, or
// as many scan lines as were written, or a warning.
class EveryDamageTest : public DamagedRecordingTest {
 protected:
  void Check(const std::string& what) {
    WriteDamaged();
    std::string error = "none";
    int num_read = 0;
    bool warned = false;
    try {
      RecordingReader reader = Open();
      ScanLine scan_line;
      while (reader.Next(&scan_line)) {
        ++num_read;
        EXPECT_LE(scan_line.num_beams(), 4) << what;
      }
      EXPECT_EQ(num_read, reader.num_scan_lines());
      warned = !reader.warnings().empty();
      for (const std::string& warning : reader.warnings()) {
        EXPECT_EQ(warning, OnOneLine(warning)) << what;
      }
    } catch (const Error& caught) {
      error = caught.what();
      EXPECT_THAT(error, HasSubstr(path_ + ": ")) << what;
    }
    EXPECT_TRUE(num_read == 2 * kNumScans || warned || error != "none")
        << what << ": " << num_read << " scan lines and no warning";
    num_whole_ += num_read == 2 * kNumScans ? 1 : 0;
    num_errors_ += error != "none" ? 1 : 0;
  }

  void ChangeBytes(int count) {
    const std::string whole = bytes_;
    std::mt19937 random(1);
    for (int i = 0; i < count; ++i) {
      // The padding of the header is no use.
      const size_t position = random() % (whole.size() - 4000);
      const size_t at = position < 100 ? position : position + 4000;
      bytes_ = whole;
      bytes_[at] = static_cast<char>(i % 2 == 0 ? random() : bytes_[at] ^ (1 << random() % 8));
      Check("byte " + std::to_string(at) + " changed");
    }
  }

  int num_whole_ = 0;
  int num_errors_ = 0;
};

TEST_F(EveryDamageTest, OfABagThatIsNotPacked) {
  Write(rosbag::compression::Uncompressed);
  ChangeBytes(2000);
  EXPECT_GT(num_whole_, 1000);  // most bytes are ranges and the like
  EXPECT_LT(num_errors_, 200);
}

TEST_F(EveryDamageTest, OfABagPackedWithBz2) {
  Write(rosbag::compression::BZ2);
  ChangeBytes(1000);
  EXPECT_LT(num_errors_, 100);
}

TEST_F(EveryDamageTest, OfABagPackedWithLz4) {
  Write(rosbag::compression::LZ4);
  ChangeBytes(1000);
  EXPECT_LT(num_errors_, 100);
}

TEST_F(EveryDamageTest, OfABagWithoutIndex) {
  Write(rosbag::compression::Uncompressed);
  SetField("index_pos", 0);
  ChangeBytes(1000);
  EXPECT_LT(num_errors_, 100);
}

TEST_F(EveryDamageTest, CutAnywhere) {
  Write(rosbag::compression::Uncompressed);
  const std::string whole = bytes_;
  for (size_t size = 0; size < whole.size(); size += size < 4200 ? 83 : 5) {
    bytes_ = whole.substr(0, size);
    Check("cut at " + std::to_string(size));
  }
}

}  // namespace
}  // namespace plumbline
