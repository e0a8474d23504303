#include "core/mapping/checked_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/testing/test_files.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Finding About(Subject about, Severity severity, const char* sentence) {
  Finding finding;
  finding.about = about;
  finding.severity = severity;
  finding.subject = "/scan";
  finding.sentence = sentence;
  return finding;
}

TEST(CheckedRecording, ScannersAtOnePoseAreAnError) {
  Rig rig;
  rig.scanners.resize(2);
  EXPECT_THAT(ErrorOf([&] { CheckPoses("my_rig.yaml", rig); }),
              HasSubstr("my_rig.yaml: all 2 scanners sit at one pose"));
  rig.scanners[1].body_from_scanner.translation.x() = 0.1;
  CheckPoses("my_rig.yaml", rig);
  rig.scanners.resize(1);
  CheckPoses("my_rig.yaml", rig);
}

TEST(CheckedRecording, WhatTheReaderTellsIsNotToldTwice) {
  Finding told = About(Subject::kClock, Severity::kWarning, "told");
  told.is_told_by_reader = true;
  const std::vector<Finding> findings = {told,
                                         About(Subject::kClock, Severity::kWarning, "new")};
  EXPECT_THAT(WarningsOf(findings), ElementsAre(HasSubstr("new")));
}

TEST(CheckedRecording, AWrongMountingIsTheCauseOfAMapThatIsNotConsistent) {
  const std::vector<Finding> findings = {
      About(Subject::kClock, Severity::kWarning, "stamps"),
      About(Subject::kMounting, Severity::kWarning, "turned by 3 deg")};
  Summary summary;
  summary.warnings = {"earlier"};
  summary.consistency.verdict = Verdict::kDoubtful;
  AddFindings(findings, &summary);
  ASSERT_TRUE(summary.cause.has_value());
  EXPECT_THAT(summary.cause->evidence, HasSubstr("/scan: turned by 3 deg"));
  EXPECT_THAT(summary.warnings,
              ElementsAre(HasSubstr("stamps"), HasSubstr("turned by 3 deg"), "earlier"));

  Summary consistent;
  consistent.consistency.verdict = Verdict::kConsistent;
  AddFindings(findings, &consistent);
  EXPECT_FALSE(consistent.cause.has_value());
}

}  // namespace
}  // namespace plumbline
