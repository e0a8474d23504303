#include "core/sensor/scan_reader.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/sensor/beam_instant.h"
#include "simulation/sensing/recording_writer.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'600'000'000'000'000'000;
constexpr int64_t kMillisecond = 1'000'000;

struct Stamp {
  int scanner;
  double time_ms;
};

class ScanReaderTest : public TemporaryDirectoryTest {
 protected:
  void SetUp() override {
    TemporaryDirectoryTest::SetUp();
    rig_.scanners.resize(3);
    for (size_t i = 0; i < 3; ++i) {
      rig_.scanners[i].name = "scanner" + std::to_string(i);
      rig_.scanners[i].topic = "/scan" + std::to_string(i);
    }
  }

  // Records scan lines of 5 beams, 2 ms apart, and reads them as scans.
  std::vector<Scan> Read(const std::vector<Stamp>& stamps) {
    const std::string path = (directory_ / "recording.bag").string();
    RecordingWriter writer(path, rig_);
    for (const Stamp& stamp : stamps) {
      ScanLine line;
      line.scanner_index = stamp.scanner;
      line.stamp_ns = kStart + static_cast<int64_t>(stamp.time_ms * kMillisecond);
      line.angle_increment = 0.25;
      line.time_increment_s = 0.001953125;  // exact in the bag's single precision
      line.ranges = {1.0f, 1.0f, 1.0f, 1.0f, 1.0f};
      writer.Write(line);
    }
    writer.Close();
    RecordingReader recording(path, rig_);
    ScanReader reader(rig_, &recording);
    std::vector<Scan> scans;
    Scan scan;
    while (reader.Next(&scan)) scans.push_back(scan);
    EXPECT_FALSE(reader.Next(&scan)) << "the end stays the end";
    return scans;
  }

  static std::vector<int> Scanners(const Scan& scan) {
    std::vector<int> scanners;
    for (const ScanLine& line : scan.scan_lines) scanners.push_back(line.scanner_index);
    return scanners;
  }

  static double Milliseconds(int64_t time_ns) {
    return static_cast<double>(time_ns - kStart) / kMillisecond;
  }

  Rig rig_;
};

using Scanners3 = std::vector<int>;

TEST_F(ScanReaderTest, GroupsSynchronisedScanners) {
  const std::vector<Scan> scans =
      Read({{0, 0}, {1, 0}, {2, 0}, {0, 25}, {1, 25}, {2, 25}, {0, 50}, {1, 50}, {2, 50}});
  ASSERT_EQ(scans.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    const int first = 3 * static_cast<int>(i);
    EXPECT_EQ(Scanners(scans[i]), (Scanners3{0, 1, 2}));
    EXPECT_EQ(scans[i].scan_line_indices, (std::vector<int>{first, first + 1, first + 2}));
    EXPECT_DOUBLE_EQ(Milliseconds(scans[i].start_ns), 25.0 * static_cast<double>(i));
    EXPECT_DOUBLE_EQ(Milliseconds(scans[i].end_ns), 25.0 * static_cast<double>(i) + 7.8125);
  }
}

TEST_F(ScanReaderTest, GroupsUnsynchronisedScanners) {
  const std::vector<Scan> scans =
      Read({{0, 0}, {1, 9}, {2, 17}, {0, 25}, {1, 34}, {2, 42}, {0, 50}, {1, 59}, {2, 67}});
  ASSERT_EQ(scans.size(), 3u);
  for (const Scan& scan : scans) EXPECT_EQ(Scanners(scan), (Scanners3{0, 1, 2}));
  EXPECT_DOUBLE_EQ(Milliseconds(scans[1].start_ns), 25.0);
  EXPECT_DOUBLE_EQ(Milliseconds(scans[1].end_ns), 42.0 + 7.8125);
}

TEST_F(ScanReaderTest, MissingScanLineDoesNotShiftTheOthers) {
  const std::vector<Scan> scans = Read({{0, 0},
                                        {1, 9},
                                        {2, 17},
                                        {0, 25},
                                        {2, 42},
                                        {0, 50},
                                        {1, 59},
                                        {2, 67},
                                        {0, 75},
                                        {1, 84},
                                        {2, 92}});
  ASSERT_EQ(scans.size(), 4u);
  EXPECT_EQ(Scanners(scans[1]), (Scanners3{0, 2}));
  EXPECT_EQ(Scanners(scans[2]), (Scanners3{0, 1, 2}));
  EXPECT_EQ(scans[2].scan_line_indices.front(), 5);
}

// The faster scanner ends scans; no scan is longer than the period.
TEST_F(ScanReaderTest, ScannersOfDifferentRates) {
  rig_.scanners.resize(2);
  const std::vector<Scan> scans =
      Read({{0, 0}, {1, 0}, {0, 20}, {1, 30}, {0, 40}, {0, 60}, {1, 60}, {0, 80}, {1, 90}});
  size_t num_lines = 0;
  for (const Scan& scan : scans) {
    num_lines += scan.scan_lines.size();
    const std::vector<int> scanners = Scanners(scan);
    EXPECT_LE(std::count(scanners.begin(), scanners.end(), 0), 1);
    EXPECT_LE(std::count(scanners.begin(), scanners.end(), 1), 1);
    EXPECT_LT(scan.scan_lines.back().stamp_ns - scan.scan_lines.front().stamp_ns,
              30 * kMillisecond);
  }
  EXPECT_EQ(num_lines, 9u);
}

TEST_F(ScanReaderTest, ScanEndsAtGap) {
  const std::vector<Scan> scans =
      Read({{0, 0}, {0, 25}, {0, 50}, {1, 500}, {2, 505}, {0, 510}});
  ASSERT_EQ(scans.size(), 4u);
  EXPECT_EQ(Scanners(scans[2]), (Scanners3{0}));
  EXPECT_EQ(Scanners(scans[3]), (Scanners3{1, 2, 0}));
}

TEST_F(ScanReaderTest, InstantsHaveTheTimeOffset) {
  rig_.scanners[0].time_offset_s = 0.004;
  rig_.scanners[2].time_offset_s = -0.003;
  const std::vector<Scan> scans = Read({{0, 0}, {1, 0}, {2, 0}, {0, 25}, {1, 25}, {2, 25}});
  ASSERT_EQ(scans.size(), 2u);
  EXPECT_DOUBLE_EQ(Milliseconds(scans[1].start_ns), 22.0);
  EXPECT_DOUBLE_EQ(Milliseconds(scans[1].end_ns), 29.0 + 7.8125);
  EXPECT_EQ(BeamInstant(scans[1].scan_lines[0], 0, rig_), kStart + 29 * kMillisecond);
  EXPECT_EQ(BeamInstant(scans[1].scan_lines[1], 1, rig_), kStart + 26'953'125);
}

// No scanner has two scan lines: there is no period.
TEST_F(ScanReaderTest, OneScanLineOfEachScannerIsAScan) {
  const std::vector<Scan> scans = Read({{0, 0}, {1, 0}, {2, 0}});
  ASSERT_EQ(scans.size(), 1u);
  EXPECT_EQ(Scanners(scans[0]), (Scanners3{0, 1, 2}));
}

TEST_F(ScanReaderTest, SingleScanLineIsAScan) {
  rig_.scanners.resize(1);
  const std::vector<Scan> scans = Read({{0, 0}});
  ASSERT_EQ(scans.size(), 1u);
  EXPECT_EQ(Scanners(scans[0]), (Scanners3{0}));
}

}  // namespace
}  // namespace plumbline
