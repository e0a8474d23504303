#include "core/recording/carmen_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "test/core/recording/carmen_text.h"
#include "test/core/recording/packing.h"
#include "test/core/recording/recording_dump.h"
#include "test/testing/paths.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class CarmenFileTest : public TemporaryDirectoryTest {
 protected:
  std::string Write(const std::string& bytes) {
    WriteBytes(directory_ / "robot.log", bytes);
    return (directory_ / "robot.log").string();
  }

  const std::string log_ =
      "# CARMEN Logfile\n# any comment\n\nPARAM robot_width 0.41 1.0 host 0.0\n" +
      FlaserLine(180, "70.1") + "ODOM 1 2 3 0 0 0 70.2 nohost 0.3\n" +
      FlaserLine(180, "70.3") + "TRUEPOS 1 2 3 1 2 3 70.4 nohost 0.4\n";
};

TEST_F(CarmenFileTest, LinesAreMessages) {
  const RecordingDump dump = Dump(Write(log_));
  EXPECT_THAT(dump.topics, ElementsAre("PARAM 1", "FLASER 2", "ODOM 1", "TRUEPOS 1"));
  // Scan lines state odometry, too.
  ASSERT_EQ(dump.messages.size(), 5u);
  EXPECT_THAT(dump.messages[0], HasSubstr("FLASER 250000000 scan 70100000000"));
  EXPECT_THAT(dump.messages[1], HasSubstr("FLASER 250000000 odometry 70100000000"));
  EXPECT_THAT(dump.messages[2], HasSubstr("ODOM 300000000 odometry 70200000000"));
  EXPECT_THAT(dump.messages[3], HasSubstr("FLASER 300000000 scan 70300000000"));
  EXPECT_THAT(dump.warnings, IsEmpty());
  EXPECT_EQ(dump.num_undecodable, 0);
}

TEST_F(CarmenFileTest, PackedLogsAreTheSame) {
  const RecordingDump expected = Dump(Write(log_));
  const std::string packed = PackBz2(log_);
  EXPECT_EQ(Dump(Write(packed)).messages, expected.messages);
  // Parallel packers write one stream after the other.
  const RecordingDump twice = Dump(Write(packed + packed));
  EXPECT_EQ(twice.messages.size(), 2 * expected.messages.size());
  EXPECT_THAT(twice.warnings, IsEmpty());
}

TEST_F(CarmenFileTest, PackedLogThatBreaksOffIsReadAsFarAsItGoes) {
  std::string log = log_;
  for (int i = 0; i < 2000; ++i) log += FlaserLine(180, std::to_string(100 + i * 7919 % 997));
  const std::string packed = PackBz2(log);
  const RecordingDump dump = Dump(Write(packed.substr(0, packed.size() - 100)));
  EXPECT_THAT(dump.warnings,
              testing::Contains("the file can not be unpacked whole, since it breaks off"));
  EXPECT_GT(dump.messages.size(), 100u);
  EXPECT_LT(dump.messages.size(), 4005u);
}

TEST_F(CarmenFileTest, FewBytesDoNotBecomeGigabytes) {
  const std::string packed = PackBz2(std::string(5'000'000, '\n'));
  std::string bomb;
  for (int i = 0; i < 30; ++i) bomb += packed;
  EXPECT_THAT(ErrorOf([&] { Dump(Write(bomb)); }),
              HasSubstr("unpacks to more than any recording does"));
  for (const auto& entry : fs::directory_iterator(directory_)) {
    EXPECT_EQ(entry.path().filename(), "robot.log");
  }
}

TEST_F(CarmenFileTest, DamagedLinesArePassedOverAndCounted) {
  const RecordingDump dump =
      Dump(Write(log_ + "\x01\x02\x03 what\nFLASER 180 1.0\nODOM 1 2 3 4 5 6 no times here\n" +
                 log_ + "ODOM"));
  EXPECT_EQ(dump.messages.size(), 10u);
  EXPECT_EQ(dump.num_undecodable, 1);
  EXPECT_THAT(
      dump.warnings,
      ElementsAre(
          HasSubstr("a line does not begin with a word and was passed over: 2 times"),
          HasSubstr("a line does not end with its times and was passed over: 31 bytes, "
                    "at byte ")));
}

TEST_F(CarmenFileTest, LineWithoutEndCostsNoMemory) {
  const RecordingDump dump = Dump(Write(log_ + "SYNC " + std::string(3'000'000, 'x')));
  EXPECT_EQ(dump.messages.size(), 5u);
  EXPECT_THAT(dump.warnings, testing::Contains(HasSubstr("what is no line was passed over")));
}

struct PublicLog {
  const char* name;
  int num_scans;
  int num_odometry;
  int num_beams;
};

// The logs are not part of the repository.
TEST(CarmenLogsTest, PublicLogsAreReadToTheEnd) {
  const std::string folder = SourceDir() + "/../shared/data/radish/";
  if (!fs::exists(folder)) GTEST_SKIP() << "no CARMEN logs at " << folder;
  for (const PublicLog& log : {PublicLog{"aces", 7374, 7375, 180},
                               PublicLog{"fr079", 4934, 8951, 360},
                               PublicLog{"intel", 13631, 26915, 180}}) {
    const std::unique_ptr<RecordingSource> source =
        OpenRecording(folder + log.name + ".clf.bz2");
    int num_scans = 0;
    int num_odometry = 0;
    RecordingVisitor visitor;
    visitor.scan_line = [&](const MessageRef&, const ScanLineMessage& scan) {
      ++num_scans;
      EXPECT_EQ(scan.num_beams, static_cast<uint32_t>(log.num_beams));
    };
    visitor.odometry = [&](const MessageRef&, const OdometryMessage&) { ++num_odometry; };
    visitor.undecodable = [&](const MessageRef& message) {
      ADD_FAILURE() << log.name << " byte " << message.begin;
    };
    source->Visit(visitor);
    EXPECT_EQ(num_scans, log.num_scans) << log.name;
    // Scan lines state odometry, too.
    EXPECT_EQ(num_odometry, log.num_scans + log.num_odometry) << log.name;
    EXPECT_THAT(source->warnings(), IsEmpty()) << log.name;
  }
}

}  // namespace
}  // namespace plumbline
