// Recordings that other people's programs have written (test/data/recordings/README.md).

#include "core/recording/recording_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/util/one_line.h"
#include "test/core/recording/recording_dump.h"
#include "test/testing/paths.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAreArray;

constexpr int kNumMessages = 6;  // of each topic
constexpr int kNumBeams = 8;
constexpr int64_t kStart = 1'600'000'000'000'000'000;
constexpr int64_t kPeriod = 100'000'000;

const char* const kFiles[] = {"chunked.mcap",
                              "zstd.mcap",
                              "lz4.mcap",
                              "unchunked.mcap",
                              "ros1.mcap",
                              "recording.db3",
                              "per_message.db3",
                              "folder"};

std::string PathOf(const std::string& name) { return TestDataDir() + "/recordings/" + name; }

// The scan lines of a topic of the ROS 1 bag.
std::vector<ScanLineMessage> ScanLinesOf(const std::string& topic_name) {
  const std::unique_ptr<RecordingSource> source = OpenRecording(PathOf("source.bag"));
  std::vector<ScanLineMessage> scan_lines;
  RecordingVisitor visitor;
  visitor.wants = [&](const RecordingTopic& topic) { return topic.name == topic_name; };
  visitor.scan_line = [&](const MessageRef&, const ScanLineMessage& scan_line) {
    scan_lines.push_back(scan_line);
  };
  source->Visit(visitor);
  EXPECT_THAT(scan_lines, SizeIs(kNumMessages));
  return scan_lines;
}

float RangeOf(int message, int beam) {
  return static_cast<float>(1.0 + 0.25 * beam + 0.5 * message);
}

TEST(RecordingSourceTest, LaserScanIsWhatWasWritten) {
  const std::vector<ScanLineMessage> scan_lines = ScanLinesOf("/top_scan");
  for (int i = 0; i < kNumMessages; ++i) {
    const ScanLineMessage& scan = scan_lines[static_cast<size_t>(i)];
    EXPECT_EQ(scan.stamp_ns, kStart + i * kPeriod);
    EXPECT_EQ(scan.frame_id, "laser");
    EXPECT_EQ(scan.angle_min, -0.5f);
    EXPECT_EQ(scan.angle_increment, 0.25f);
    EXPECT_EQ(scan.time_increment, 0.001f);
    EXPECT_EQ(scan.range_min, 0.125f);
    EXPECT_EQ(scan.range_max, 30.0f);
    ASSERT_EQ(scan.num_beams, 8u);
    ASSERT_THAT(scan.ranges, SizeIs(kNumBeams));
    for (int beam = 0; beam < kNumBeams; ++beam) {
      EXPECT_EQ(scan.ranges[static_cast<size_t>(beam)], RangeOf(i, beam));
    }
    EXPECT_THAT(scan.angles, IsEmpty());
    EXPECT_TRUE(scan.IsUsable());
  }
}

TEST(RecordingSourceTest, FirstOfSeveralEchoesCounts) {
  const std::vector<ScanLineMessage> scan_lines = ScanLinesOf("/echoes");
  for (int beam = 0; beam < kNumBeams; ++beam) {
    const float range = scan_lines[2].ranges[static_cast<size_t>(beam)];
    if (beam % 3 == 0) {
      EXPECT_TRUE(std::isnan(range)) << beam;
    } else {
      EXPECT_EQ(range, RangeOf(2, beam));
    }
  }
}

// The cloud lacks the point of beam 3, which has no return.
TEST(RecordingSourceTest, PointCloudOfRegularBeamsIsTheScanLineThatItWasMadeOf) {
  const std::vector<ScanLineMessage> scan_lines = ScanLinesOf("/cloud");
  for (int i = 0; i < kNumMessages; ++i) {
    const ScanLineMessage& scan = scan_lines[static_cast<size_t>(i)];
    EXPECT_NEAR(static_cast<double>(scan.stamp_ns - kStart - i * kPeriod), 0.0, 1.0);
    EXPECT_NEAR(scan.angle_min, -0.5f, 1e-6f);
    EXPECT_NEAR(scan.angle_increment, 0.25f, 1e-6f);
    EXPECT_NEAR(scan.time_increment, 0.001f, 1e-8f);
    EXPECT_THAT(scan.angles, IsEmpty());
    ASSERT_THAT(scan.ranges, SizeIs(kNumBeams));
    for (int beam = 0; beam < kNumBeams; ++beam) {
      const float range = scan.ranges[static_cast<size_t>(beam)];
      if (beam == 3) {
        EXPECT_TRUE(std::isnan(range));
      } else {
        EXPECT_NEAR(range, RangeOf(i, beam), 1e-6f);
      }
    }
    EXPECT_TRUE(scan.is_planar);
    EXPECT_TRUE(scan.IsUsable());
  }
}

TEST(RecordingSourceTest, PointCloudOfIrregularBeamsKeepsTheirAngles) {
  const auto angle_of = [](int beam) { return -0.5 + 0.25 * beam + 0.01 * beam * beam; };
  for (const ScanLineMessage& scan : ScanLinesOf("/odd_cloud")) {
    EXPECT_NEAR(scan.time_increment, 0.001f, 1e-8f);
    EXPECT_NEAR(scan.angle_increment, (angle_of(7) - angle_of(0)) / 7.0, 1e-6);
    ASSERT_THAT(scan.angles, SizeIs(kNumBeams));
    ASSERT_THAT(scan.ranges, SizeIs(kNumBeams));
    for (int beam = 0; beam < kNumBeams; ++beam) {
      const double angle = scan.angles[static_cast<size_t>(beam)];
      if (beam == 3) {  // between its neighbours
        EXPECT_NEAR(angle, 0.5 * (angle_of(2) + angle_of(4)), 1e-6);
        EXPECT_TRUE(std::isnan(scan.ranges[3]));
      } else {
        EXPECT_NEAR(angle, angle_of(beam), 1e-6);
      }
    }
    EXPECT_TRUE(scan.IsUsable());
  }
}

TEST(RecordingSourceTest, OdometryIsWhatWasWritten) {
  const std::unique_ptr<RecordingSource> source = OpenRecording(PathOf("source.bag"));
  int i = 0;
  RecordingVisitor visitor;
  visitor.odometry = [&](const MessageRef& message, const OdometryMessage& odometry) {
    EXPECT_EQ(source->topics()[message.topic_index].name, "/odom");
    EXPECT_EQ(odometry.stamp_ns, kStart + i * kPeriod);
    EXPECT_EQ(odometry.frame_id, "odom");
    EXPECT_EQ(odometry.child_frame_id, "base_link");
    EXPECT_EQ(odometry.position[0], std::sin(0.1 * i));
    EXPECT_NEAR(odometry.Yaw(), 0.1 * i, 1e-12);
    EXPECT_EQ(odometry.linear_velocity[0], 1.0);
    EXPECT_EQ(odometry.angular_velocity[2], 1.0);
    ++i;
  };
  source->Visit(visitor);
  EXPECT_EQ(i, kNumMessages);
}

// A copy of a recording, of which one file may be damaged.
class TemporaryCopy {
 public:
  explicit TemporaryCopy(const std::string& path) {
    std::string pattern = (fs::temp_directory_path() / "plumbline_XXXXXX").string();
    directory_ = mkdtemp(pattern.data());
    fs::copy(path, copy(), fs::copy_options::recursive);
    file_ = fs::is_directory(path) ? copy() / "recording_1.db3.zstd" : copy();
  }
  ~TemporaryCopy() { fs::remove_all(directory_); }

  std::string path() const { return copy().string(); }
  fs::path file() const { return file_; }

 private:
  fs::path copy() const { return directory_ / "recording"; }

  fs::path directory_;
  fs::path file_;
};

class EveryFormatTest : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryFormatTest, HoldsWhatTheRos1BagHolds) {
  const RecordingDump expected = Dump(PathOf("source.bag"));
  const RecordingDump dump = Dump(PathOf(GetParam()));
  EXPECT_EQ(expected.messages.size(), 5u * kNumMessages);
  EXPECT_EQ(dump.messages, expected.messages);
  EXPECT_EQ(dump.num_undecodable, 0);
  EXPECT_THAT(dump.warnings, IsEmpty());
  if (std::string(GetParam()) == "folder") {
    EXPECT_THAT(dump.topics, SizeIs(2 * expected.topics.size()));
  } else {
    EXPECT_THAT(dump.topics, UnorderedElementsAreArray(expected.topics));
  }
}

TEST_P(EveryFormatTest, VisitsWhatIsWanted) {
  const std::unique_ptr<RecordingSource> source = OpenRecording(PathOf(GetParam()));
  std::map<std::string, int> counts;
  RecordingVisitor visitor;
  visitor.with_ranges = false;
  visitor.wants = [](const RecordingTopic& topic) {
    return topic.name == "/echoes" || topic.name == "/odom";
  };
  visitor.scan_line = [&](const MessageRef& message, const ScanLineMessage& scan) {
    EXPECT_THAT(scan.ranges, IsEmpty());
    EXPECT_EQ(scan.num_beams, 8u);
    ++counts[source->topics()[message.topic_index].name];
  };
  source->Visit(visitor);
  EXPECT_THAT(counts, ElementsAre(std::make_pair("/echoes", kNumMessages)));
}

// One byte changed anywhere, or the end cut off: an Error on one line that names the file, all
// messages, or fewer with a warning; never more than there are.
TEST_P(EveryFormatTest, DamageIsToldOrLosesNothing) {
  const TemporaryCopy copy(PathOf(GetParam()));
  const std::string whole = ReadBytes(copy.file());
  uint32_t random = 1;
  int num_errors = 0;
  constexpr int kNumTrials = 120;
  for (int trial = 0; trial < kNumTrials; ++trial) {
    random = random * 1664525u + 1013904223u;
    const size_t at = (random >> 4) % whole.size();
    std::string bytes = trial % 4 == 0 ? whole.substr(0, at) : whole;
    if (trial % 4 != 0) bytes[at] = static_cast<char>(bytes[at] ^ (1 << (random % 8)));
    WriteBytes(copy.file(), bytes);
    try {
      const RecordingDump dump = Dump(copy.path());
      EXPECT_LE(dump.messages.size(), 5u * kNumMessages) << at;
      if (dump.messages.size() < 5u * kNumMessages && trial % 4 == 0) {
        EXPECT_TRUE(dump.num_undecodable > 0 || !dump.warnings.empty()) << at;
      }
      for (const std::string& warning : dump.warnings) EXPECT_EQ(warning, OnOneLine(warning));
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(copy.path())) << at;
      ++num_errors;
    }
  }
  EXPECT_LT(num_errors, kNumTrials / 2);
}

class DamagedFileTest : public TemporaryDirectoryTest {};

// The length of one message is damaged: the index of its chunk shows where the next one
// begins.
TEST_F(DamagedFileTest, OneDamagedMessageOfAChunkCostsOnlyItself) {
  std::string bytes = ReadBytes(PathOf("chunked.mcap"));
  const float angles[] = {-0.5f, 1.25f, 0.25f};
  const std::string pattern(reinterpret_cast<const char*>(angles), sizeof(angles));
  // Before it: encapsulation, stamp, frame, head of the message (22), its length (8).
  const size_t content = bytes.find(pattern) - 4 - 8 - 4 - 8;
  const size_t length = content - 22 - 8;
  ASSERT_EQ(bytes[length - 1], 5) << "no message record";
  bytes[length + 5] = 1;
  const std::string path = (directory_ / "damaged.mcap").string();
  WriteBytes(path, bytes);
  const RecordingDump dump = Dump(path);
  EXPECT_EQ(dump.messages.size(), 5u * kNumMessages - 1);
  EXPECT_THAT(
      dump.warnings,
      testing::IsSupersetOf(
          {HasSubstr("the checksum of a chunk does not fit its bytes: at byte "),
           HasSubstr("what is no record was passed over in a chunk: "),
           HasSubstr("topic /top_scan: the summary of the recording states 6 messages, "
                     "but 5 could be found")}));
}

// A page of the database is lost, and what lies behind it is not.
TEST_F(DamagedFileTest, DatabaseIsReadOnBehindADamage) {
  std::string bytes = ReadBytes(PathOf("recording.db3"));
  constexpr size_t kPageBytes = 1024;
  const size_t page = bytes.find("laser", bytes.size() / 2) / kPageBytes;
  ASSERT_GT(page, 4u);
  bytes.replace(page * kPageBytes, 8, std::string(8, '\xff'));
  const std::string path = (directory_ / "damaged.db3").string();
  WriteBytes(path, bytes);
  const RecordingDump dump = Dump(path);
  EXPECT_GT(dump.messages.size(), 2u * kNumMessages);
  EXPECT_LT(dump.messages.size(), 5u * kNumMessages);
  EXPECT_THAT(
      dump.warnings,
      ElementsAre(AllOf(HasSubstr("damaged database: messages are lost after the first "),
                        Not(HasSubstr(" 0 messages behind")))));
}

// A copy that broke off, shorter than its header says.
TEST_F(DamagedFileTest, ACutDatabaseIsReadAsFarAsItGoes) {
  const std::string bytes = ReadBytes(PathOf("recording.db3"));
  const std::string path = (directory_ / "cut.db3").string();
  constexpr size_t kPageBytes = 1024;
  WriteBytes(path, bytes.substr(0, bytes.size() - 2 * kPageBytes - 100));
  const RecordingDump dump = Dump(path);
  EXPECT_GT(dump.messages.size(), 2u * kNumMessages);
  EXPECT_LT(dump.messages.size(), 5u * kNumMessages);
  EXPECT_THAT(dump.warnings,
              ElementsAre(HasSubstr("damaged database: messages are lost after the first ")));
}

INSTANTIATE_TEST_SUITE_P(OtherPrograms, EveryFormatTest, ::testing::ValuesIn(kFiles));

}  // namespace
}  // namespace plumbline
