// The shipped recording of a real robot is read whole.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/options/config.h"
#include "core/sensor/recording.h"

namespace plumbline {
namespace {

TEST(RobotRecordingTest, IsReadWholeAndInOrder) {
  Rig rig;
  for (const char* name : {"left", "right", "rear"}) {
    Scanner scanner;
    scanner.name = name;
    scanner.topic = "/" + scanner.name + "_scan";
    rig.scanners.push_back(scanner);
  }
  RecordingReader reader(PLUMBLINE_TEST_DATA_DIR "/robot_three_scanners.bag", rig);
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

TEST(RobotRecordingTest, ShippedRigAndSettingsAreRead) {
  const Rig rig = ReadRig(PLUMBLINE_CONFIGS_DIR "/rigs/robot_three_scanners.yaml");
  EXPECT_EQ(rig.scanners.size(), 3u);
  EXPECT_TRUE(AllScannersHorizontal(rig, 1e-9));
  const MapperOptions options =
      ReadMapperOptions(PLUMBLINE_CONFIGS_DIR "/mapper/robot_three_scanners.yaml");
  EXPECT_DOUBLE_EQ(options.trajectory.min_scans_per_knot, 1.0);
}

}  // namespace
}  // namespace plumbline
