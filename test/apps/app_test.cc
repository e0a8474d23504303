#include "apps/app.h"

#include <gflags/gflags.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "apps/help.h"
#include "core/util/error.h"

DEFINE_string(recording, "", "a flag that has to be given");
DEFINE_int32(threads, 1, "a number, < 9 & > 0");
DEFINE_bool(fast, false, "a switch");

namespace plumbline {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;

struct Outcome {
  int exit_code = -1;
  bool ran = false;
  std::string out;
  std::string err;
};

Outcome RunWith(std::vector<std::string> arguments, bool fail = false) {
  FLAGS_recording = "";
  FLAGS_threads = 1;
  FLAGS_fast = false;
  arguments.insert(arguments.begin(), "/usr/bin/some_app");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  Outcome outcome;
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  outcome.exit_code = RunApp(static_cast<int>(argv.size()),
                             argv.data(),
                             "does something",
                             __FILE__,
                             {"recording"},
                             [&] {
                               outcome.ran = true;
                               if (fail) throw Error("file.yaml:3: broken");
                             });
  outcome.out = ::testing::internal::GetCapturedStdout();
  outcome.err = ::testing::internal::GetCapturedStderr();
  return outcome;
}

TEST(AppTest, SetsFlagsAndRuns) {
  const Outcome outcome = RunWith({"--recording=a.bag", "-threads", "3", "--fast"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(outcome.ran);
  EXPECT_EQ(FLAGS_recording, "a.bag");
  EXPECT_EQ(FLAGS_threads, 3);
  EXPECT_TRUE(FLAGS_fast);
  EXPECT_EQ(RunWith({"--fast", "--nofast", "--recording=b"}).exit_code, 0);
  EXPECT_FALSE(FLAGS_fast);
}

TEST(AppTest, HelpShowsOurFlagsOnly) {
  const Outcome outcome = RunWith({"--help"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_FALSE(outcome.ran);
  EXPECT_NE(outcome.out.find("--threads"), std::string::npos);
  EXPECT_EQ(outcome.out.find("logtostderr"), std::string::npos);
}

TEST(AppTest, HelpIsAsWideAsAsked) {
  const Help help = {"some_app", "does something that takes a few words to say", __FILE__, {}};
  std::istringstream lines(HelpText(help, 40));
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 40u) << line;
  }
  EXPECT_THAT(HelpText(help, 40),
              HasSubstr("some_app: does something that takes a\nfew words to say\n"));
  EXPECT_THAT(HelpText(help, 40),
              HasSubstr("  --recording  a flag that has to be\n"
                        "               given\n"
                        "  --threads    a number, < 9 & > 0\n"
                        "               (default: 1)\n"));
}

TEST(AppTest, HelpForProgramsIsXmlOfOurFlags) {
  const Outcome outcome = RunWith({"--helpxml"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_FALSE(outcome.ran);
  EXPECT_THAT(outcome.out, StartsWith("<?xml version=\"1.0\"?>\n<AllFlags>\n"));
  EXPECT_THAT(outcome.out, HasSubstr("<program>some_app</program>"));
  EXPECT_THAT(outcome.out, HasSubstr("<usage>does something</usage>"));
  EXPECT_THAT(outcome.out,
              HasSubstr("<flag><name>threads</name><meaning>a number, &lt; 9 &amp; &gt; 0"
                        "</meaning><default>1</default><type>int32</type></flag>"));
  EXPECT_THAT(outcome.out, HasSubstr("<type>string</type><required/></flag>"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("logtostderr")));
}

TEST(AppTest, VersionIsOneLine) {
  const Outcome outcome = RunWith({"--version"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_FALSE(outcome.ran);
  EXPECT_THAT(
      outcome.out,
      MatchesRegex("some_app [0-9]+\\.[0-9]+\\.[0-9]+( \\(commit [0-9a-f]+\\+?\\))?\n"));
}

TEST(AppTest, WrongUsageIsTwo) {
  const std::vector<std::vector<std::string>> wrong = {{},
                                                       {"--recording"},
                                                       {"--recording=a", "--no_such_flag=1"},
                                                       {"--recording=a", "--threads=many"},
                                                       {"--recording=a", "stray"},
                                                       {"--recording=a", "---fast"},
                                                       {"--recording=a", "--"},
                                                       {"--recording=a", "--nothreads"}};
  for (const std::vector<std::string>& arguments : wrong) {
    const Outcome outcome = RunWith(arguments);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_FALSE(outcome.ran);
    EXPECT_NE(outcome.err.find("--help"), std::string::npos);
  }
}

TEST(AppTest, FailureIsOneLineAndOne) {
  const Outcome outcome = RunWith({"--recording=a"}, true);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err, "some_app: file.yaml:3: broken\n");
}

}  // namespace
}  // namespace plumbline
