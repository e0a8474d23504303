#include "core/recording/carmen_file.h"

#include <bzlib.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/recording/carmen_messages.h"
#include "test/core/recording/recording_dump.h"
#include "test/testing/paths.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

ByteView ViewOf(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

// A line of a front laser, its ranges 1, 2, ... cm longer than a metre.
std::string FlaserLine(int num_ranges, const std::string& time) {
  std::string line = "FLASER " + std::to_string(num_ranges);
  for (int i = 0; i < num_ranges; ++i) {
    line += " 1." + std::string(i < 10 ? "0" : "") + std::to_string(i % 100);
  }
  return line + " 0.1 0.2 0.3 0.1 0.2 0.3 " + time + " nohost 0.250000\n";
}

std::string PackBz2(const std::string& text) {
  std::string packed(text.size() + 1000, '\0');
  auto size = static_cast<unsigned>(packed.size());
  EXPECT_EQ(BZ2_bzBuffToBuffCompress(packed.data(),
                                     &size,
                                     const_cast<char*>(text.data()),
                                     static_cast<unsigned>(text.size()),
                                     9,
                                     0,
                                     0),
            BZ_OK);
  return packed.substr(0, size);
}

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
