// Recordings as the simulator makes them, looked at before they are mapped.

#include "core/judging/check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/judging/check_job.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

class CheckTest : public MappingTest {
 protected:
  SimulatedRecording Walk(const std::string& more = "") {
    Scenario scenario;
    scenario.building = HexagonalRoom();
    scenario.scanners = TiltedRig();
    scenario.path = HexagonWalk(8.0, 1.0);
    scenario.more = more;
    return Simulate(scenario);
  }
  CheckReport Check(const SimulatedRecording& recording) {
    WriteRecording(recording);
    return CheckRecording(Path("recording.bag"), ReadRig(Path("rig.yaml")));
  }
  static std::string Words(const CheckReport& report) {
    std::string words;
    for (const Finding& finding : report.findings) {
      if (finding.severity == Severity::kNote) continue;
      words += finding.subject + ": " + finding.sentence + "\n";
    }
    return words;
  }
};

TEST_F(CheckTest, AGoodRecordingCanBeMapped) {
  const CheckReport report = Check(Walk());
  EXPECT_EQ(report.mappable, Mappable::kInSpace);
  EXPECT_EQ(Words(report), "");
  EXPECT_GT(report.starts.num_starts, 0);
}

TEST_F(CheckTest, ARigFileThatIsWrongIsTold) {
  WriteRecording(Walk());
  Rig rig = ReadRig(Path("rig.yaml"));
  std::swap(rig.scanners[1].topic, rig.scanners[2].topic);
  const CheckReport report = CheckRecording(Path("recording.bag"), rig);
  EXPECT_EQ(report.mappable, Mappable::kNot);
  EXPECT_THAT(Words(report), HasSubstr("are exchanged"));
}

TEST_F(CheckTest, ARigFileThatIsNotFilledInIsTold) {
  WriteRecording(Walk());
  Rig rig = ReadRig(Path("rig.yaml"));
  for (Scanner& scanner : rig.scanners) scanner.body_from_scanner = Rigid3d();
  EXPECT_EQ(CheckRecording(Path("recording.bag"), rig).mappable, Mappable::kNot);
}

TEST_F(CheckTest, AScannerThatIsMirroredIsTold) {
  SimulatedRecording recording = Walk();
  for (ScanLine& line : recording.scan_lines) {
    if (line.scanner_index == 0) std::reverse(line.ranges.begin(), line.ranges.end());
  }
  const CheckReport report = Check(recording);
  EXPECT_EQ(report.mappable, Mappable::kNot);
  EXPECT_THAT(Words(report), HasSubstr("is mirrored"));
}

TEST_F(CheckTest, MillimetresAreTold) {
  SimulatedRecording recording = Walk();
  for (ScanLine& line : recording.scan_lines) {
    for (float& range : line.ranges) range *= 1000.0F;
  }
  const CheckReport report = Check(recording);
  EXPECT_EQ(report.mappable, Mappable::kNot);
  EXPECT_THAT(Words(report), HasSubstr("millimetres"));
}

TEST_F(CheckTest, ATopicThatIsNotThereIsTold) {
  SimulatedRecording recording = Walk();
  recording.rig.scanners[1].topic = "/elsewhere";
  WriteRecording(recording);
  Rig rig = ReadRig(Path("rig.yaml"));
  rig.scanners[2].topic = "/nowhere";
  const CheckReport report = CheckRecording(Path("recording.bag"), rig);
  EXPECT_EQ(report.mappable, Mappable::kNot);
  EXPECT_THAT(Words(report), HasSubstr("/nowhere: the recording has no such topic"));
}

TEST_F(CheckTest, WithoutARigFileAFirstOneIsWritten) {
  const SimulatedRecording recording = Walk();
  WriteRecording(recording);
  const CheckOutcome outcome = RunCheckJob({Path("recording.bag"), "", Path("check")});
  EXPECT_TRUE(outcome.is_mappable);
  const Rig rig = ReadRig(Path("check/rig.yaml"));
  ASSERT_EQ(rig.scanners.size(), 3u);
  for (const Scanner& scanner : rig.scanners) {
    EXPECT_NEAR(scanner.range_noise_m, recording.rig.scanners[0].range_noise_m, 0.004);
  }
  EXPECT_THAT(ReadBytes(Path("check/check.svg")), HasSubstr("</svg>"));
  EXPECT_THAT(ReadBytes(Path("check/check.json")), HasSubstr("\"findings\""));
}

}  // namespace
}  // namespace plumbline
