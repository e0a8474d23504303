// The shipped recording of a real robot is read whole.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/LaserScan.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/sensor/recording.h"
#include "test/testing/paths.h"

namespace plumbline {
namespace {

const std::string kBag = TestDataDir() + "/robot_three_scanners.bag";

Rig RobotRig() {
  Rig rig;
  for (const char* name : {"left", "right", "rear"}) {
    Scanner scanner;
    scanner.name = name;
    scanner.topic = "/" + scanner.name + "_scan";
    rig.scanners.push_back(scanner);
  }
  return rig;
}

// What ROS' own library reads, in the order of stamps and scanners.
std::vector<std::pair<int, sensor_msgs::LaserScan>> ReadWithRos(const Rig& rig) {
  std::vector<std::pair<int, sensor_msgs::LaserScan>> scans;
  rosbag::Bag bag(kBag);
  rosbag::View view(bag);
  for (const rosbag::MessageInstance& instance : view) {
    for (size_t i = 0; i < rig.scanners.size(); ++i) {
      if (instance.getTopic() != rig.scanners[i].topic) continue;
      scans.emplace_back(static_cast<int>(i), *instance.instantiate<sensor_msgs::LaserScan>());
    }
  }
  std::stable_sort(scans.begin(), scans.end(), [](const auto& a, const auto& b) {
    return std::tie(a.second.header.stamp, a.first) < std::tie(b.second.header.stamp, b.first);
  });
  return scans;
}

TEST(RobotRecordingTest, ScanLinesAreThoseThatRosReads) {
  const Rig rig = RobotRig();
  const auto expected = ReadWithRos(rig);
  RecordingReader reader(kBag, rig);
  for (const auto& [scanner_index, scan] : expected) {
    ScanLine scan_line;
    ASSERT_TRUE(reader.Next(&scan_line));
    ASSERT_EQ(scan_line.scanner_index, scanner_index);
    ASSERT_EQ(scan_line.stamp_ns, static_cast<int64_t>(scan.header.stamp.toNSec()));
    ASSERT_EQ(scan_line.angle_min, scan.angle_min);
    ASSERT_EQ(scan_line.angle_increment, scan.angle_increment);
    ASSERT_EQ(scan_line.time_increment_s, scan.time_increment);
    ASSERT_EQ(scan_line.ranges.size(), scan.ranges.size());
    for (size_t i = 0; i < scan.ranges.size(); ++i) {
      // The robot's driver gives the stated limit where there is no return.
      if (scan.ranges[i] == scan.range_max) {
        ASSERT_TRUE(std::isnan(scan_line.ranges[i]));
      } else {
        ASSERT_EQ(scan_line.ranges[i], scan.ranges[i]);
      }
    }
  }
  ScanLine scan_line;
  EXPECT_FALSE(reader.Next(&scan_line));
}

TEST(RobotRecordingTest, IsReadWholeAndInOrder) {
  RecordingReader reader(kBag, RobotRig());
  EXPECT_THAT(reader.warnings(), testing::IsEmpty());
  EXPECT_EQ(reader.num_scan_lines(), 1304);
  EXPECT_NEAR(SecondsBetween(reader.start_ns(), reader.end_ns()), 57.839, 0.001);
  EXPECT_NEAR(reader.scan_period_s(), 1.0 / 7.5, 1e-3);

  std::vector<int> num_scan_lines(3, 0);
  int64_t last_ns = reader.start_ns();
  ScanLine scan_line;
  while (reader.Next(&scan_line)) {
    ++num_scan_lines[static_cast<size_t>(scan_line.scanner_index)];
    EXPECT_GE(scan_line.stamp_ns, last_ns);
    last_ns = scan_line.stamp_ns;
    EXPECT_EQ(scan_line.num_beams(), 768);
    EXPECT_NEAR(scan_line.angle_increment * 767, 1.5 * M_PI, 0.01);
    EXPECT_NEAR(scan_line.time_increment_s, 1.0 / 7.5 / 2048, 1e-7);
  }
  EXPECT_THAT(num_scan_lines, testing::ElementsAre(435, 434, 435));
  EXPECT_EQ(last_ns, reader.end_ns());
}

TEST(RobotRecordingTest, ShippedRigIsRead) {
  const Rig rig = ReadRig(ConfigsDir() + "/rigs/robot_three_scanners.yaml");
  EXPECT_EQ(rig.scanners.size(), 3u);
  EXPECT_TRUE(AllScannersHorizontal(rig, 1e-9));
}

}  // namespace
}  // namespace plumbline
