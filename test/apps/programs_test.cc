// Runs the programs themselves: exit codes and what they say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>

#include "test/testing/paths.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::HasSubstr;

struct Outcome {
  int exit_code = -1;
  std::string err;
};

class ProgramsTest : public TemporaryDirectoryTest {
 protected:
  Outcome Run(const std::string& command) {
    const std::string err = Path("stderr");
    const int status = std::system(
        (ProgramsDir() + "/" + command + " > " + Path("stdout") + " 2> " + err).c_str());
    Outcome outcome;
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    outcome.err = ReadBytes(err);
    return outcome;
  }
  // Exit code 1, one line that names what is at fault, and no output.
  void ExpectFailure(const std::string& command, const std::string& fault) {
    const Outcome outcome = Run(command);
    EXPECT_EQ(outcome.exit_code, 1) << command;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(fault));
    EXPECT_FALSE(std::filesystem::exists(Path("out/summary.json")));
  }
  std::string Path(const std::string& name) const { return (directory_ / name).string(); }
  std::string RigFile() const { return ConfigsDir() + "/rigs/paper.yaml"; }
};

TEST_F(ProgramsTest, MapperNamesMissingFiles) {
  ExpectFailure("plumbline_map --recording=" + Path("no.bag") + " --rig=" + RigFile() +
                    " --output=" + Path("out"),
                Path("no.bag"));
  ExpectFailure("plumbline_map --recording=" + Path("no.bag") + " --rig=" + Path("no.yaml") +
                    " --output=" + Path("out"),
                Path("no.yaml"));
}

TEST_F(ProgramsTest, MapperNamesBrokenFiles) {
  WriteBytes(Path("broken.bag"), "#ROSBAG V2.0\nand then nothing of the kind");
  ExpectFailure("plumbline_map --recording=" + Path("broken.bag") + " --rig=" + RigFile() +
                    " --output=" + Path("out"),
                Path("broken.bag"));
  WriteBytes(Path("config.yaml"), "window:\n  scans: 3\n");
  ExpectFailure("plumbline_map --recording=" + Path("broken.bag") + " --rig=" + RigFile() +
                    " --config=" + Path("config.yaml") + " --output=" + Path("out"),
                Path("config.yaml") + ":2");
}

TEST_F(ProgramsTest, SimulatorAndEvaluatorNameMissingFiles) {
  ExpectFailure(
      "plumbline_simulate --experiment=" + Path("no.yaml") + " --output=" + Path("out"),
      Path("no.yaml"));
  ExpectFailure("plumbline_bound --experiment=" + Path("no.yaml") + " --output=" + Path("out"),
                Path("no.yaml"));
  ExpectFailure("plumbline_evaluate --result=" + Path("no") + " --truth=" + Path("no"),
                Path("no"));
}

TEST_F(ProgramsTest, ExportNamesAMissingMap) {
  ExpectFailure("plumbline_export --result=" + Path("no") + " --formats=las --output=" +
                    Path("out"),
                Path("no/map.ply"));
}

TEST_F(ProgramsTest, AReportNeedsThePointsAsPly) {
  ExpectFailure("plumbline_map --recording=" + Path("no.bag") + " --rig=" + RigFile() +
                    " --output=" + Path("out") + " --report --formats=las",
                "a report is made from map.ply");
}

TEST_F(ProgramsTest, ReportNamesAMissingResult) {
  ExpectFailure("plumbline_report --result=" + Path("no"), Path("no/summary.json"));
  // Without the flag.
  ExpectFailure("plumbline_report " + Path("no"), Path("no/summary.json"));
  // One argument may stand alone, a second one is a mistake.
  EXPECT_EQ(Run("plumbline_report " + Path("no") + " " + Path("more")).exit_code, 2);
}

TEST_F(ProgramsTest, CheckSaysWhetherARecordingCanBeMapped) {
  ExpectFailure("plumbline_check " + Path("no.bag") + " --output=" + Path("out"),
                Path("no.bag"));
  const std::string robot = TestDataDir() + "/robot_three_scanners.bag";
  const std::string command = "plumbline_check " + robot + " --output=" + Path("out");
  EXPECT_EQ(Run(command).exit_code, 0);
  EXPECT_THAT(ReadBytes(Path("stdout")), HasSubstr("can be mapped in the plane"));
  // None of its topics is there.
  EXPECT_EQ(Run(command + " --rig=" + RigFile()).exit_code, 3);
  EXPECT_THAT(ReadBytes(Path("stdout")), HasSubstr("the recording has no such topic"));
}

// A map is written where the rig file is wrong, but the exit code says what it is worth.
TEST_F(ProgramsTest, AMapThatContradictsItselfIsThree) {
  ASSERT_EQ(Run("plumbline_simulate --experiment=" + ConfigsDir() +
                "/experiments/room.yaml --seed=1 --output=" + Path("room"))
                .exit_code,
            0);
  const std::string command =
      "plumbline_map " + Path("room/recording.bag") + " --output=" + Path("out");
  EXPECT_EQ(Run(command).exit_code, 0);
  std::string rig = ReadBytes(Path("room/rig.yaml"));
  const std::string is_there = "translation: [0, 0.1, 0]";
  ASSERT_THAT(rig, HasSubstr(is_there));
  rig.replace(rig.find(is_there), is_there.size(), "translation: [0, 0.6, 0]");
  WriteBytes(Path("room/rig.yaml"), rig);
  EXPECT_EQ(Run(command).exit_code, 1);
  const Outcome outcome = Run(command + " --force");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("do not trust it"));
  EXPECT_THAT(ReadBytes(Path("stdout")), HasSubstr("Verdict: contradictory"));
  EXPECT_THAT(ReadBytes(Path("out/summary.json")), HasSubstr("\"contradictory\""));
}

TEST_F(ProgramsTest, WrongUsageIsTwo) {
  for (const char* program :
       {"plumbline_bound",
        "plumbline_check",
        "plumbline_evaluate",
        "plumbline_export",
        "plumbline_map",
        "plumbline_plan",
        "plumbline_report",
        "plumbline_simulate"}) {
    EXPECT_EQ(Run(program).exit_code, 2) << program;
    EXPECT_EQ(Run(std::string(program) + " --no_such_flag").exit_code, 2) << program;
    EXPECT_EQ(Run(std::string(program) + " --help").exit_code, 0) << program;
  }
  const Outcome outcome = Run("plumbline_map --threads=-1");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("flag --threads does not take the value '-1'"));
  EXPECT_EQ(Run("plumbline_map --formats=ply,laz").exit_code, 2);
  EXPECT_EQ(Run("plumbline_export --result=. --formats=laz").exit_code, 2);
}

}  // namespace
}  // namespace plumbline
