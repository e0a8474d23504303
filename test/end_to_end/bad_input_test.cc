#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "core/result/result_reader.h"
#include "core/result/result_writer.h"
#include "core/util/time.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// Recordings that are not as they should be: each ends in a map and a warning or in one line.
class BadInputTest : public MappingTest {
 protected:
  SimulatedRecording Record(double length_m = 4.0) {
    Scenario scenario;
    scenario.building = TrapezoidRoom();
    scenario.scanners = TiltedRig();
    scenario.path = TrapezoidWalk(length_m, 1.0);
    return Simulate(scenario);
  }

  static double SecondsIn(const SimulatedRecording& recording, const ScanLine& scan_line) {
    return SecondsBetween(recording.scan_lines.front().stamp_ns, scan_line.stamp_ns);
  }

  static int NumScans(const SimulatedRecording& recording) {
    return static_cast<int>(recording.scan_lines.size() / recording.rig.scanners.size());
  }

  template <typename Condition>
  static void Remove(SimulatedRecording* recording, Condition condition) {
    std::vector<ScanLine>& lines = recording->scan_lines;
    lines.erase(std::remove_if(lines.begin(), lines.end(), condition), lines.end());
  }

  // An earlier result that a failing run has to leave alone.
  void PutEarlierResult() {
    fs::create_directory(Path("result"));
    for (const char* file : kFiles) {
      WriteBytes(directory_ / "result" / file, std::string("earlier ") + file);
    }
  }
  void ExpectEarlierResultUntouched() {
    size_t num_files = 0;
    for (const auto& entry : fs::directory_iterator(Path("result"))) {
      ++num_files;
      EXPECT_EQ(ReadBytes(entry.path()), "earlier " + entry.path().filename().string());
    }
    EXPECT_EQ(num_files, std::size(kFiles));
  }

  static constexpr const char* kFiles[] = {"trajectory.tum",
                                           "planes.json",
                                           "planes.ply",
                                           "rig_used.yaml",
                                           "map.ply",
                                           "map.pcd",
                                           "summary.json",
                                           "config_used.yaml"};
};

TEST_F(BadInputTest, MissingFilesAreNamed) {
  WriteRecording(Record(1.0));
  fs::rename(Path("recording.bag"), Path("elsewhere.bag"));
  EXPECT_THAT(MapError(), HasSubstr(Path("recording.bag")));
  fs::rename(Path("elsewhere.bag"), Path("recording.bag"));
  fs::remove(Path("rig.yaml"));
  EXPECT_THAT(MapError(), HasSubstr(Path("rig.yaml")));
}

TEST_F(BadInputTest, RecordingThatBreaksOffAtOnceIsAnError) {
  WriteRecording(Record(1.0));
  const std::string bytes = ReadBytes(Path("recording.bag"));
  for (const size_t size : {0, 1000, 5000}) {
    WriteBytes(Path("recording.bag"), bytes.substr(0, size));
    EXPECT_THAT(MapError(), HasSubstr(Path("recording.bag"))) << size;
  }
  WriteBytes(Path("recording.bag"), "this is no bag\n");
  EXPECT_THAT(MapError(), HasSubstr(Path("recording.bag")));
}

TEST_F(BadInputTest, RecordingThatBreaksOffIsMappedSoFar) {
  const SimulatedRecording recording = Record();
  WriteRecording(recording);
  const auto size = static_cast<double>(fs::file_size(Path("recording.bag")));
  fs::resize_file(Path("recording.bag"), static_cast<size_t>(0.8 * size));
  Map();
  EXPECT_THAT(summary_.warnings, Contains(HasSubstr("damaged bag: ")));
  EXPECT_GT(summary_.scans, 7 * NumScans(recording) / 10);
  ExpectTruePlanes(EvaluateResult(recording));
}

// What a recorder leaves that is killed: recording.bag.active.
TEST_F(BadInputTest, RecordingWithoutIndexIsMapped) {
  const SimulatedRecording recording = Record();
  WriteRecording(recording);
  std::string bytes = ReadBytes(Path("recording.bag"));
  const size_t field = bytes.find("index_pos=") + 10;
  uint64_t index_position = 0;
  std::memcpy(&index_position, bytes.data() + field, 8);
  bytes.resize(index_position);
  bytes.replace(field, 8, std::string(8, '\0'));
  WriteBytes(Path("recording.bag"), bytes);
  Map();
  EXPECT_THAT(summary_.warnings, Contains(HasSubstr("was never closed and has no index")));
  EXPECT_EQ(summary_.scans, NumScans(recording));
  ExpectTruePlanes(EvaluateResult(recording));
}

TEST_F(BadInputTest, TopicThatIsNotThereIsNamed) {
  SimulatedRecording recording = Record(1.0);
  WriteRecording(recording);
  recording.rig.scanners[1].topic = "/not_recorded";
  WriteRig(recording.rig, Path("rig.yaml"));
  EXPECT_THAT(MapError(), HasSubstr("/not_recorded"));
}

TEST_F(BadInputTest, RecordingWithoutScansIsAnError) {
  SimulatedRecording recording = Record(1.0);
  recording.scan_lines.clear();
  WriteRecording(recording);
  EXPECT_THAT(MapError(), HasSubstr(Path("recording.bag")));
}

TEST_F(BadInputTest, ScansWithoutReturnsAreAnError) {
  for (const float nothing : {kInfinity, kNaN, 0.0f, -1.0f}) {
    SimulatedRecording recording = Record(1.0);
    for (ScanLine& scan_line : recording.scan_lines) {
      std::fill(scan_line.ranges.begin(), scan_line.ranges.end(), nothing);
    }
    WriteRecording(recording);
    EXPECT_THAT(MapError(), HasSubstr("no start"));
  }
}

TEST_F(BadInputTest, SingleScanIsEnoughForAnAnswer) {
  SimulatedRecording recording = Record(1.0);
  recording.scan_lines.resize(3);
  WriteRecording(recording);
  const std::string message = ErrorOf([this] { Map(); });
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST_F(BadInputTest, ScanLinesWithoutBeamsAreAnError) {
  SimulatedRecording recording = Record(1.0);
  for (ScanLine& scan_line : recording.scan_lines) scan_line.ranges.clear();
  WriteRecording(recording);
  EXPECT_THAT(MapError(), HasSubstr("recording.bag"));
}

TEST_F(BadInputTest, FailedRunLeavesEarlierResultAlone) {
  SimulatedRecording recording = Record(1.0);
  for (ScanLine& scan_line : recording.scan_lines) {
    std::fill(scan_line.ranges.begin(), scan_line.ranges.end(), kInfinity);
  }
  WriteRecording(recording);
  PutEarlierResult();
  EXPECT_NE(ErrorOf([this] { Map(); }), "no error");
  ExpectEarlierResultUntouched();
}

TEST_F(BadInputTest, FullDiskLeavesEarlierResultAlone) {
  WriteRecording(Record(1.5));
  PutEarlierResult();
  {
    const FileSizeLimit limit(200'000);
    EXPECT_THAT(ErrorOf([this] { Map(); }), HasSubstr(Path("result")));
  }
  ExpectEarlierResultUntouched();
}

TEST_F(BadInputTest, OutputThatIsAFileIsAnError) {
  WriteRecording(Record(1.5));
  WriteBytes(Path("result"), "a file");
  EXPECT_THAT(MapError(), HasSubstr(Path("result")));
  EXPECT_EQ(ReadBytes(Path("result")), "a file");
}

TEST_F(BadInputTest, ConfigErrorNamesFileAndLine) {
  WriteRecording(Record(1.0));
  const std::string message =
      ErrorOf([this] { Map("window:\n  num_scans: 10\n  size: 3\n"); });
  EXPECT_THAT(message, HasSubstr(Path("config.yaml") + ":3"));
  EXPECT_THAT(message, HasSubstr("size"));
}

TEST_F(BadInputTest, StampsThatJumpBackArePassedOver) {
  SimulatedRecording recording = Record();
  int count = 0;
  for (ScanLine& scan_line : recording.scan_lines) {
    if (++count % 50 == 0) scan_line.stamp_ns -= NanosecondsFromSeconds(1.3);
  }
  WriteRecording(recording);
  Map();
  EXPECT_THAT(summary_.warnings, Contains(HasSubstr("passed over")));
  ExpectTruePlanes(EvaluateResult(recording));
}

TEST_F(BadInputTest, RangesThatAreNoReturnsAreIgnored) {
  SimulatedRecording recording = Record();
  const float nothing[] = {kNaN, kInfinity, 0.0f, -1.0f, -kInfinity, 1e30f, 0.01f};
  size_t next = 0;
  for (ScanLine& scan_line : recording.scan_lines) {
    for (size_t beam = next % 11; beam < scan_line.ranges.size(); beam += 11) {
      scan_line.ranges[beam] = nothing[next++ % std::size(nothing)];
    }
  }
  WriteRecording(recording);
  Map();
  ExpectTruePlanes(EvaluateResult(recording));
}

TEST_F(BadInputTest, ScanLinesNeedNotHaveTheSameBeams) {
  SimulatedRecording recording = Record();
  size_t count = 0;
  for (ScanLine& scan_line : recording.scan_lines) {
    scan_line.ranges.resize(scan_line.ranges.size() - 7 * (count % 5));
    if (++count % 40 == 0) scan_line.ranges.resize(1);
    if (count % 57 == 0) scan_line.ranges.clear();
  }
  WriteRecording(recording);
  Map();
  EXPECT_THAT(summary_.warnings, Contains(HasSubstr("no ranges")));
  ExpectTruePlanes(EvaluateResult(recording));
}

TEST_F(BadInputTest, ScannerThatStopsIsNoticed) {
  SimulatedRecording recording = Record();
  Remove(&recording, [&](const ScanLine& scan_line) {
    return scan_line.scanner_index == 1 && SecondsIn(recording, scan_line) > 2.0;
  });
  WriteRecording(recording);
  Map();
  EXPECT_THAT(summary_.warnings, Contains(HasSubstr("stops early")));
  ExpectTruePlanes(EvaluateResult(recording));
}

TEST_F(BadInputTest, MapEndsAtGapOfSeconds) {
  SimulatedRecording recording = Record(6.0);
  const int64_t start_ns = recording.scan_lines.front().stamp_ns;
  Remove(&recording, [&](const ScanLine& scan_line) {
    const double time_s = SecondsBetween(start_ns, scan_line.stamp_ns);
    return time_s > 2.5 && time_s < 4.5;
  });
  WriteRecording(recording);
  Map();
  EXPECT_THAT(summary_.warnings, Contains(HasSubstr("the map ends")));
  // No true plane is required that only the rest would have shown: all of them are in view.
  ExpectTruePlanes(EvaluateResult(recording));
  EXPECT_LT(
      SecondsBetween(start_ns, ReadTrajectory(Path("result/trajectory.tum")).back().time_ns),
      2.6);
}

TEST_F(BadInputTest, BridgesGapsOfTenthsOfASecond) {
  SimulatedRecording recording = Record();
  const int64_t start_ns = recording.scan_lines.front().stamp_ns;
  Remove(&recording, [&](const ScanLine& scan_line) {
    return std::fmod(SecondsBetween(start_ns, scan_line.stamp_ns), 1.0) > 0.7;
  });
  WriteRecording(recording);
  Map();
  ExpectTruePlanes(EvaluateResult(recording));
}

TEST_F(BadInputTest, StartsWhereFirstScansShowNothing) {
  SimulatedRecording recording = Record();
  for (ScanLine& scan_line : recording.scan_lines) {
    if (SecondsIn(recording, scan_line) >= 0.5) continue;
    std::fill(scan_line.ranges.begin(), scan_line.ranges.end(), kInfinity);
  }
  WriteRecording(recording);
  Map();
  EXPECT_THAT(summary_.warnings, Contains(HasSubstr("the first 10 scans are left out")));
  ExpectTruePlanes(EvaluateResult(recording));
}

TEST_F(BadInputTest, BridgesScansWithoutReturns) {
  SimulatedRecording recording = Record();
  for (ScanLine& scan_line : recording.scan_lines) {
    const double time_s = SecondsIn(recording, scan_line);
    if (time_s < 2.0 || time_s > 2.09) continue;
    std::fill(scan_line.ranges.begin(), scan_line.ranges.end(), kInfinity);
  }
  WriteRecording(recording);
  Map();
  ExpectTruePlanes(EvaluateResult(recording));
}

// When nothing is in view for good, the estimate has to say so instead of guessing on.
// The first rig file that plumbline_check writes, not filled in.
TEST_F(BadInputTest, ScannersAtOnePoseAreAnError) {
  SimulatedRecording recording = Record();
  for (Scanner& scanner : recording.rig.scanners) scanner.body_from_scanner = Rigid3d();
  WriteRecording(recording);
  EXPECT_THAT(MapError(),
              HasSubstr("rig.yaml: all 3 scanners sit at one pose: fill in body_from_scanner"));
}

// What was followed until the pose is open, half a second later, is too short for a map.
TEST_F(BadInputTest, LosesTrackWhenAllScannersGoBlind) {
  SimulatedRecording recording = Record();
  for (ScanLine& scan_line : recording.scan_lines) {
    if (SecondsIn(recording, scan_line) < 1.0) continue;
    std::fill(scan_line.ranges.begin(), scan_line.ranges.end(), kNaN);
  }
  WriteRecording(recording);
  EXPECT_THAT(MapError(), HasSubstr("lost track"));
}

}  // namespace
}  // namespace plumbline
