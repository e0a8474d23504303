#include "core/sensor/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/MultiEchoLaserScan.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "simulation/sensing/recording_writer.h"
#include "test/core/sensor/recording_fixture.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

// Beams' directions come from a table that lines of the same angles share.
TEST_F(RecordingTest, DirectionsFollowTheAnglesOfEachLine) {
  const Rig rig = MakeRig({"top", "left"});
  RecordingWriter writer(path_, rig);
  for (int i = 0; i < 8; ++i) {
    ScanLine scan_line = MakeScanLine(i % 2, kStart + i * kPeriod);
    if (i == 2) scan_line.angle_min = 0.25f;
    if (i == 4) scan_line.ranges.assign(9, 2.0f);
    if (i == 6) scan_line.angle_increment = -0.5f;
    writer.Write(scan_line);
  }
  writer.Close();
  RecordingReader reader(path_, rig);
  const std::vector<ScanLine> read = ReadAll(&reader);
  ASSERT_EQ(read.size(), 8u);
  for (const ScanLine& scan_line : read) {
    ASSERT_NE(scan_line.directions, nullptr);
    for (int beam = -1; beam <= scan_line.num_beams(); ++beam) {
      const double angle = scan_line.angle_min + beam * scan_line.angle_increment;
      EXPECT_EQ(scan_line.BeamDirection(beam),
                Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  EXPECT_EQ(read[1].directions, read[7].directions);
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

TEST_F(RecordingTest, WriterThatRunsOutOfSpaceFailsAndLeavesNothing) {
  const std::string error = ErrorOf([&] {
    const FileSizeLimit limit(100'000);
    RecordingWriter writer(path_, MakeRig({"top"}));
    for (int i = 0; i < 2000; ++i) writer.Write(MakeScanLine(0, kStart + i * kPeriod));
    writer.Close();
  });
  EXPECT_THAT(error, HasSubstr(path_ + ": can not be written"));
  EXPECT_TRUE(fs::is_empty(directory_));
}

TEST_F(RecordingTest, WriterNamesTheFileItCanNotWrite) {
  const std::string path = (directory_ / "missing" / "recording.bag").string();
  EXPECT_THAT(ErrorOf([&] { RecordingWriter writer(path, MakeRig({"top"})); }),
              HasSubstr(path + ": can not be written"));
}

TEST_F(RecordingTest, RefusesWhatIsNoRecording) {
  EXPECT_EQ(OpenError({"top"}), path_ + ": no such file");
  WriteBytes(path_, "#ROSBAG V1.2\n");
  EXPECT_THAT(OpenError({"top"}), HasSubstr(path_ + ": is no recording that can be read"));
  fs::resize_file(path_, 0);
  EXPECT_THAT(OpenError({"top"}), HasSubstr(path_ + ": is no recording that can be read"));
  fs::remove(path_);
  path_ = directory_.string();
  EXPECT_THAT(OpenError({"top"}), HasSubstr(path_ + ": is a folder without a recording"));
}

TEST_F(RecordingTest, NamesTheTopicsThereAreWhenOneIsMissing) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    Record(&bag, "/top_scan", MakeMessage(kStart));
    Record(&bag, "/left_scan", MakeMessage(kStart));
    Record(&bag, "/imu", sensor_msgs::Imu());
  }
  EXPECT_EQ(OpenError({"top", "rear"}),
            path_ +
                ": has no topic /rear_scan (scanner 'rear' of the rig); topics with laser " +
                "scans in this recording: /left_scan, /top_scan");
}

TEST_F(RecordingTest, RefusesTopicsOfAnotherType) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    Record(&bag, "/top_scan", sensor_msgs::Imu());
  }
  EXPECT_THAT(OpenError({"top"}),
              AllOf(HasSubstr("topic /top_scan (scanner 'top' of the rig) is of type "
                              "sensor_msgs/Imu"),
                    HasSubstr("topics with laser scans in this recording: none")));
}

TEST_F(RecordingTest, RefusesTwoScannersOnOneTopic) {
  RecordStamps({0, 25});
  Rig rig = MakeRig({"top", "left"});
  rig.scanners[1].topic = rig.scanners[0].topic;
  EXPECT_THAT(ErrorOf([&] { RecordingReader reader(path_, rig); }),
              HasSubstr("scanners 'top' and 'left' of the rig name the same topic /top_scan"));
}

TEST_F(RecordingTest, RefusesARecordingWithoutAUsableScanLine) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    sensor_msgs::LaserScan message = MakeMessage(kStart);
    message.ranges.clear();
    Record(&bag, "/top_scan", message);
  }
  EXPECT_THAT(OpenError({"top"}),
              AllOf(HasSubstr(path_ + ": has no scan lines of the rig's scanners"),
                    HasSubstr("1 scan line passed over: no ranges")));
}

TEST_F(RecordingTest, PassesOverStampsThatJumpBack) {
  RecordStamps({0, 25, 50, 75, 30, 55, 100, 125});
  RecordingReader reader(path_, MakeRig({"top"}));
  EXPECT_THAT(DeliveredStampsMs(&reader), ElementsAre(0, 25, 50, 75, 100, 125));
  EXPECT_THAT(reader.warnings(),
              ElementsAre("scanner 'top': 2 scan lines passed over: time stamps that jump "
                          "against the others, first at 0.075 s"));
}

TEST_F(RecordingTest, OneStampInTheFutureCostsOneScanLine) {
  RecordStamps({0, 25, 9000, 50, 75, 100});
  RecordingReader reader(path_, MakeRig({"top"}));
  EXPECT_THAT(DeliveredStampsMs(&reader), ElementsAre(0, 25, 50, 75, 100));
  EXPECT_THAT(reader.warnings(), ElementsAre(HasSubstr("1 scan line passed over")));
}

TEST_F(RecordingTest, PassesOverRepeatedStamps) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    for (int i = 0; i < 6; ++i) {
      sensor_msgs::LaserScan message = MakeMessage(kStart + (i / 2) * kPeriod);
      message.ranges[0] = static_cast<float>(i);
      Record(&bag, "/top_scan", message);
    }
  }
  RecordingReader reader(path_, MakeRig({"top"}));
  const std::vector<ScanLine> scan_lines = ReadAll(&reader);
  ASSERT_EQ(scan_lines.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(scan_lines[i].ranges[0], 2.0f * static_cast<float>(i)) << "not the first one";
  }
  EXPECT_THAT(reader.warnings(),
              ElementsAre("scanner 'top': 3 scan lines passed over: time stamps repeated, "
                          "first at 0.000 s"));
}

TEST_F(RecordingTest, AcceptsChangingNumbersOfBeams) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    for (size_t i = 0; i < 4; ++i) {
      sensor_msgs::LaserScan message = MakeMessage(kStart + static_cast<int64_t>(i) * kPeriod);
      message.ranges.assign(10 + i, 1.0f);
      Record(&bag, "/top_scan", message);
    }
  }
  RecordingReader reader(path_, MakeRig({"top"}));
  const std::vector<ScanLine> scan_lines = ReadAll(&reader);
  ASSERT_EQ(scan_lines.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(scan_lines[static_cast<size_t>(i)].num_beams(), 10 + i);
  }
  EXPECT_THAT(reader.warnings(), IsEmpty());
}

TEST_F(RecordingTest, PassesOverWhatMakesNoSense) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::function<void(sensor_msgs::LaserScan*)>> damages = {
      [](auto* message) { message->ranges.clear(); },
      [](auto* message) { message->angle_increment = 0.0f; },
      [nan](auto* message) { message->angle_increment = nan; },
      [nan](auto* message) { message->angle_min = nan; },
      [](auto* message) { message->time_increment = -1.0f; },
      [nan](auto* message) { message->time_increment = nan; },
      [](auto* message) { message->time_increment = 1.0f; },
  };
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    Record(&bag, "/top_scan", MakeMessage(kStart));
    int64_t stamp_ns = kStart;
    for (const auto& damage : damages) {
      sensor_msgs::LaserScan message = MakeMessage(stamp_ns += kPeriod);
      damage(&message);
      Record(&bag, "/top_scan", message);
    }
    Record(&bag, "/top_scan", MakeMessage(stamp_ns += kPeriod));
  }
  RecordingReader reader(path_, MakeRig({"top"}));
  EXPECT_THAT(DeliveredStampsMs(&reader), ElementsAre(0, 200));
  EXPECT_THAT(reader.warnings(),
              ElementsAre("scanner 'top': 7 scan lines passed over: no ranges, or angles or "
                          "times that make no sense (no beams), first at 0.025 s"));
}

TEST_F(RecordingTest, NamesTheUnitOfTimeIncrements) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    sensor_msgs::LaserScan message = MakeMessage(kStart);
    message.ranges.assign(100, 1.0f);
    message.time_increment = 70000.0f;
    Record(&bag, "/top_scan", message);
  }
  EXPECT_THAT(ErrorOf([&] { RecordingReader(path_, MakeRig({"top"})); }),
              AllOf(HasSubstr("has no scan lines of the rig's scanners"),
                    HasSubstr("in nanoseconds it would take 7 ms (time_increment_s: 7e-05)")));
}

TEST_F(RecordingTest, RangesAtTheStatedLimitAreNoReturns) {
  for (const float limit : {4.0f, 30.0f}) {
    {
      rosbag::Bag bag(path_, rosbag::bagmode::Write);
      sensor_msgs::LaserScan message = MakeMessage(kStart);
      message.range_max = limit;
      message.ranges = {limit, 0.5f * limit, 0.9995f * limit, 2.0f * limit};
      Record(&bag, "/top_scan", message);
    }
    RecordingReader reader(path_, MakeRig({"top"}));
    const std::vector<ScanLine> lines = ReadAll(&reader);
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_TRUE(std::isnan(lines[0].ranges[0]));
    EXPECT_EQ(lines[0].ranges[1], 0.5f * limit);
    EXPECT_EQ(lines[0].ranges[2], 0.9995f * limit);
    EXPECT_EQ(lines[0].ranges[3], 2.0f * limit);  // who states too little is believed
  }
}

TEST_F(RecordingTest, TheRigFileReplacesHeaders) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    sensor_msgs::LaserScan message = MakeMessage(kStart);
    message.time_increment = 1e6f;  // in ns
    Record(&bag, "/top_scan", message);
  }
  Rig rig = MakeRig({"top"});
  rig.scanners[0].time_increment_s = 0.002;
  rig.scanners[0].angle_min_rad = -1.5;
  rig.scanners[0].angle_increment_rad = 0.5;
  RecordingReader reader(path_, rig);
  const std::vector<ScanLine> lines = ReadAll(&reader);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NEAR(lines[0].time_increment_s, 0.002, 1e-9);
  EXPECT_NEAR(lines[0].BeamAngle(0), -1.5, 1e-6);
  EXPECT_NEAR(lines[0].BeamAngle(2), -0.5, 1e-6);
}

TEST_F(RecordingTest, BeamsTakenInReverseAreTurnedRound) {
  RecordStamps({0});
  Rig rig = MakeRig({"top"});
  rig.scanners[0].time_increment_s = -0.001;
  RecordingReader reader(path_, rig);
  const std::vector<ScanLine> lines = ReadAll(&reader);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].stamp_ns, kStart - 2 * kMillisecond);
  EXPECT_EQ(lines[0].ranges, (std::vector<float>{3.0f, 2.0f, 1.0f}));
  EXPECT_NEAR(lines[0].BeamAngle(0), 0.0, 1e-6);
  EXPECT_NEAR(lines[0].BeamAngle(2), -0.5, 1e-6);
  EXPECT_NEAR(lines[0].time_increment_s, 0.001, 1e-9);
}

TEST_F(RecordingTest, PassesRangesThroughAsTheyAre) {
  const float infinity = std::numeric_limits<float>::infinity();
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    sensor_msgs::LaserScan message = MakeMessage(kStart);
    message.ranges = {std::nanf(""), infinity, 0.0f, -1.0f};
    Record(&bag, "/top_scan", message);
  }
  RecordingReader reader(path_, MakeRig({"top"}));
  ScanLine scan_line;
  ASSERT_TRUE(reader.Next(&scan_line));
  ASSERT_EQ(scan_line.num_beams(), 4);
  EXPECT_TRUE(std::isnan(scan_line.ranges[0]));
  EXPECT_EQ(scan_line.ranges[1], infinity);
  EXPECT_EQ(scan_line.ranges[2], 0.0f);
  EXPECT_EQ(scan_line.ranges[3], -1.0f);
  EXPECT_FALSE(reader.Next(&scan_line));
  EXPECT_EQ(reader.scan_period_s(), 0.0);
}

TEST_F(RecordingTest, TakesTheFirstOfSeveralEchoes) {
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    sensor_msgs::MultiEchoLaserScan message;
    message.header.stamp.fromNSec(static_cast<uint64_t>(kStart));
    message.header.frame_id = "laser";
    message.angle_increment = 0.25f;
    message.ranges.resize(3);
    message.ranges[0].echoes = {4.0f, 5.0f, 6.0f};
    message.ranges[2].echoes = {7.0f};
    Record(&bag, "/top_scan", message);
  }
  RecordingReader reader(path_, MakeRig({"top"}));
  ScanLine scan_line;
  ASSERT_TRUE(reader.Next(&scan_line));
  ASSERT_EQ(scan_line.num_beams(), 3);
  EXPECT_EQ(scan_line.ranges[0], 4.0f);
  EXPECT_TRUE(std::isnan(scan_line.ranges[1]));
  EXPECT_EQ(scan_line.ranges[2], 7.0f);
}

TEST_F(RecordingTest, WarnsOfScannersThatStopEarlyOrStartLate) {
  const Rig rig = MakeRig({"top", "left", "right"});
  RecordingWriter writer(path_, rig);
  for (int i = 0; i < 200; ++i) {
    writer.Write(MakeScanLine(0, kStart + i * kPeriod));
    if (i <= 100) writer.Write(MakeScanLine(1, kStart + i * kPeriod));
    if (i >= 80) writer.Write(MakeScanLine(2, kStart + i * kPeriod));
  }
  writer.Close();
  RecordingReader reader(path_, rig);
  EXPECT_THAT(
      reader.warnings(),
      ElementsAre("scanner 'left' stops early: its last scan line is at 2.500 s, 2.475 "
                  "s before the end of the recording",
                  "scanner 'right' starts late: its first scan line is at 2.000 s"));
}

TEST_F(RecordingTest, WarnsOfGapsInAllScanners) {
  const Rig rig = MakeRig({"top", "left"});
  RecordingWriter writer(path_, rig);
  for (int i = 0; i < 200; ++i) {
    if (i > 40 && i < 80) continue;    // 1 s, in all scanners
    if (i > 100 && i < 119) continue;  // 0.475 s: too short to matter
    writer.Write(MakeScanLine(0, kStart + i * kPeriod));
    if (i < 130 || i > 160) writer.Write(MakeScanLine(1, kStart + i * kPeriod));
  }
  writer.Close();
  RecordingReader reader(path_, rig);
  EXPECT_THAT(reader.warnings(),
              ElementsAre("no scanner delivered anything for 1.000 s after 1.000 s"));
}

TEST_F(RecordingTest, ListsTenGapsAndCountsTheOthers) {
  std::vector<int> stamps_ms;
  for (int burst = 0; burst < 14; ++burst) {
    for (int i = 0; i < 5; ++i) stamps_ms.push_back(1000 * burst + 25 * i);
  }
  RecordStamps(stamps_ms);
  RecordingReader reader(path_, MakeRig({"top"}));
  ASSERT_EQ(reader.warnings().size(), 11u);
  EXPECT_EQ(reader.warnings().back(), "3 more gaps longer than 0.500 s");
}

// Records two scanners with the receipt order that `first` decides, and reads them in the
// order of their stamps.
TEST_F(RecordingTest, DeliversInOrderOfStampsWhateverTheOrderInTheBag) {
  const Rig rig = MakeRig({"top", "left"});
  constexpr int kNumScanLines = 1500;  // more than the reader holds back
  for (const int delay : {3, kNumScanLines}) {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    bag.setChunkThreshold(4096);
    for (int i = 0; i < kNumScanLines + delay; ++i) {
      const int late = i - delay;
      if (i < kNumScanLines) Record(&bag, "/left_scan", MakeMessage(kStart + i * kPeriod));
      if (late >= 0) Record(&bag, "/top_scan", MakeMessage(kStart + late * kPeriod));
    }
    bag.close();
    RecordingReader reader(path_, rig);
    for (int pass = 0; pass < 2; ++pass) {
      ScanLine scan_line;
      for (int i = 0; i < 2 * kNumScanLines; ++i) {
        ASSERT_TRUE(reader.Next(&scan_line));
        ASSERT_EQ(scan_line.stamp_ns, kStart + (i / 2) * kPeriod);
        ASSERT_EQ(scan_line.scanner_index, i % 2);
      }
      EXPECT_FALSE(reader.Next(&scan_line));
      reader.Rewind();
    }
    EXPECT_THAT(reader.warnings(), IsEmpty());
  }
}

class OdometryFaultTest : public RecordingTest {
 protected:
  // Odometry that goes on by step_m from message to message, beside a scanner's lines.
  void Record(double step_m, double orientation_w) {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    for (int i = 0; i < 20; ++i) {
      nav_msgs::Odometry message;
      message.header.stamp.fromNSec(static_cast<uint64_t>(kStart + i * kPeriod));
      message.pose.pose.position.x = i * step_m;
      message.pose.pose.orientation.w = orientation_w;
      RecordingTest::Record(&bag, "/top_scan", MakeMessage(kStart + i * kPeriod));
      RecordingTest::Record(&bag, "/wheels", message);
    }
  }

  // What is said of the odometry; whether it is used.
  std::pair<std::vector<std::string>, bool> Read() {
    Rig rig = MakeRig({"top"});
    rig.odometry_topic = "/wheels";
    const RecordingReader reader(path_, rig);
    return {reader.warnings(), reader.odometry() != nullptr};
  }
};

TEST_F(OdometryFaultTest, WheelsThatTurnAreUsed) {
  Record(0.001, 1.0);
  const auto [warnings, is_used] = Read();
  EXPECT_TRUE(is_used);
  EXPECT_THAT(warnings, IsEmpty());
}

TEST_F(OdometryFaultTest, PosesWithoutOrientationAreLeftOut) {
  Record(0.02, 0.0);
  const auto [warnings, is_used] = Read();
  EXPECT_FALSE(is_used);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings.front(),
            "odometry is left out: 20 of 20 messages have no orientation (their quaternion is "
            "not of length 1)");
}

TEST_F(OdometryFaultTest, AFrozenPoseIsLeftOut) {
  Record(0.0, 1.0);
  const auto [warnings, is_used] = Read();
  EXPECT_FALSE(is_used);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings.front(), "odometry is left out: its pose never changes");
}

class ImuTopicTest : public RecordingTest {
 protected:
  // An IMU at rest beside a scanner's lines, whose gravity has this length.
  void Record(double gravity) {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    for (int i = 0; i < 20; ++i) {
      sensor_msgs::Imu message;
      message.header.stamp.fromNSec(static_cast<uint64_t>(kStart + i * kPeriod));
      message.angular_velocity.y = 0.01 * i;
      message.linear_acceleration.z = gravity;
      RecordingTest::Record(&bag, "/top_scan", MakeMessage(kStart + i * kPeriod));
      RecordingTest::Record(&bag, "/imu", message);
    }
  }

  Rig RigWith(const std::string& topic) {
    Rig rig = MakeRig({"top"});
    rig.imu.emplace();
    rig.imu->topic = topic;
    rig.imu->time_offset_s = 0.5;
    return rig;
  }
};

TEST_F(ImuTopicTest, ReadingsHaveTheRecordingsTime) {
  Record(9.8);
  const RecordingReader reader(path_, RigWith("/imu"));
  EXPECT_THAT(reader.warnings(), IsEmpty());
  ASSERT_NE(reader.imu(), nullptr);
  EXPECT_EQ(reader.imu()->size(), 20u);
  const int64_t third_ns = kStart + 3 * kPeriod + 500'000'000;
  const ImuMean mean = reader.imu()->MeanOf(third_ns, third_ns + 1);
  EXPECT_EQ(mean.num_samples, 1);
  EXPECT_DOUBLE_EQ(mean.angular_rate.y(), 0.03);
  EXPECT_DOUBLE_EQ(mean.specific_force.z(), 9.8);
}

TEST_F(ImuTopicTest, ReadingsInOtherUnitsAreLeftOut) {
  Record(1.0);
  const RecordingReader reader(path_, RigWith("/imu"));
  EXPECT_EQ(reader.imu(), nullptr);
  ASSERT_EQ(reader.warnings().size(), 1u);
  EXPECT_EQ(
      reader.warnings().front(),
      "the IMU is left out: its accelerations are 1.00 m/s^2 as a rule, where gravity alone "
      "is 9.81 (other units, or gravity taken off?)");
}

TEST_F(ImuTopicTest, ATopicThatIsMissingIsNamed) {
  Record(9.8);
  try {
    RecordingReader reader(path_, RigWith("/imu/raw"));
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              path_ +
                  ": has no sensor_msgs/Imu in topic /imu/raw that the rig names; topics with "
                  "IMUs in this recording: /imu");
  }
}

class MountTopicTest : public RecordingTest {
 protected:
  // A joint that turns by 0.1 rad from one of a scanner's lines to the next, beside one that
  // stands. first, last: of the messages that are left out.
  void Record(int first_lost = 0, int last_lost = -1) {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    for (int i = 0; i < 20; ++i) {
      const int64_t stamp_ns = kStart + i * kPeriod;
      RecordingTest::Record(&bag, "/top_scan", MakeMessage(stamp_ns));
      if (i >= first_lost && i <= last_lost) continue;
      sensor_msgs::JointState message;
      message.header.stamp.fromNSec(static_cast<uint64_t>(stamp_ns));
      message.name = {"other", "nod"};
      message.position = {7.0, 0.1 * i};
      RecordingTest::Record(&bag, "/joint_states", message);
    }
  }

  Rig RigWith(const std::string& topic, const std::string& joint) {
    Rig rig = MakeRig({"top"});
    Mount mount;
    mount.joint_topic = topic;
    mount.joint = joint;
    mount.time_offset_s = 0.001;
    rig.scanners[0].mount = mount;
    return rig;
  }

  std::string ErrorWith(const std::string& topic, const std::string& joint) {
    try {
      RecordingReader reader(path_, RigWith(topic, joint));
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(MountTopicTest, AnglesHaveTheRecordingsTime) {
  Record();
  Rig rig = RigWith("/joint_states", "nod");
  const RecordingReader reader(path_, rig);
  EXPECT_THAT(reader.warnings(), IsEmpty());
  PlaceScanners(reader, &rig);
  EXPECT_EQ(rig.scanners[0].mount->start_ns, kStart);
  EXPECT_NEAR(
      rig.scanners[0].mount->AngleAt(kStart + 3 * kPeriod + 1'000'000, 0.0), 0.3, 1e-9);
  EXPECT_EQ(reader.num_scan_lines(), 20);
}

TEST_F(MountTopicTest, LinesWithoutAnAngleArePassedOverAndCounted) {
  Record(5, 9);
  const RecordingReader reader(path_, RigWith("/joint_states", "nod"));
  EXPECT_LT(reader.num_scan_lines(), 20);
  EXPECT_GE(reader.num_scan_lines(), 12);
  ASSERT_EQ(reader.warnings().size(), 1u);
  EXPECT_THAT(reader.warnings().front(),
              testing::HasSubstr("passed over as nothing tells the angle of the mount then"));
}

TEST_F(MountTopicTest, WhatDoesNotTellTheAngleIsNamed) {
  Record();
  EXPECT_EQ(ErrorWith("/joints", "nod"),
            path_ +
                ": has no angles in topic /joints of the mount of scanner 'top'; topics "
                "with angles in this recording: /joint_states");
  EXPECT_EQ(ErrorWith("/joint_states", "tilt"),
            path_ +
                ": topic /joint_states does not tell how the mount of scanner 'top' turns by "
                "joint 'tilt': it has no readings");
  EXPECT_EQ(ErrorWith("/joint_states", "other"),
            path_ +
                ": topic /joint_states does not tell how the mount of scanner 'top' turns by "
                "joint 'other': its angle never changes");
}

// A rig file that states the time between beams puts it right.
TEST_F(RecordingTest, BeamsWithoutTimesOfTheirOwnAreNamed) {
  sensor_msgs::LaserScan message = MakeMessage(kStart);
  message.time_increment = 0.0f;
  {
    rosbag::Bag bag(path_, rosbag::bagmode::Write);
    Record(&bag, "/top_scan", message);
  }
  Rig rig = MakeRig({"top"});
  EXPECT_THAT(RecordingReader(path_, rig).warnings(),
              ElementsAre("scanner 'top': time_increment is 0 in 1 message: all beams of a "
                          "scan line count as measured at once; time_increment_s in the rig "
                          "file replaces it"));
  rig.scanners.front().time_increment_s = 1e-4;
  EXPECT_THAT(RecordingReader(path_, rig).warnings(), IsEmpty());
}

}  // namespace
}  // namespace plumbline
