#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/judging/findings.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// Two scanners with a scan line each, of which nothing was compared.
CheckReport TwoScanners() {
  CheckReport report;
  report.rig = Rig();
  report.rig->scanners.resize(2);
  report.rig->scanners[0].topic = "/a";
  report.rig->scanners[1].topic = "/b";
  report.survey.topics.resize(2);
  report.survey.topics[0].name = "/a";
  report.survey.topics[1].name = "/b";
  report.survey.sample.assign(2, std::vector<ScanLine>(1));
  report.topics_of_scanners = {0, 1};
  report.attitudes.resize(2);
  report.heights.resize(2);
  report.agreements = {{0, 1, 100, 0.1, 0.5}};
  report.corrections.resize(2);
  return report;
}

// Of a rig file that was not filled in, the first cause is that, not where the scanners see
// other places.
TEST(RigFindings, NamesARigFileThatWasNotFilledIn) {
  CheckReport report = TwoScanners();
  FindRigFaults(&report);
  ASSERT_FALSE(report.findings.empty());
  const Finding& first = report.findings.front();
  EXPECT_EQ(first.severity, Severity::kStop);
  EXPECT_EQ(first.about, Subject::kMounting);
  EXPECT_EQ(first.sentence, "all 2 scanners sit at one pose");
  EXPECT_THAT(first.advice, HasSubstr("body_from_scanner"));
}

TEST(RigFindings, NamesPairsThatSeeOtherPlaces) {
  CheckReport report = TwoScanners();
  report.rig->scanners[1].body_from_scanner.translation.x() = 0.1;
  FindRigFaults(&report);
  ASSERT_FALSE(report.findings.empty());
  EXPECT_THAT(report.findings.front().sentence, HasSubstr("do not see the same places"));
  EXPECT_EQ(report.findings.front().severity, Severity::kStop);
}

TEST(RigFindings, NoMapIsStoppedThatBeginsWhereTheScannersAgree) {
  CheckReport report = TwoScanners();
  report.rig->scanners[1].body_from_scanner.translation.x() = 0.1;
  report.near = MountedRig(2);
  FindRigFaults(&report);
  ASSERT_FALSE(report.findings.empty());
  EXPECT_EQ(report.findings.front().severity, Severity::kWarning);
  EXPECT_THAT(report.findings.front().advice,
              HasSubstr("plumbline_map begins where the scanners agree"));
}

// In a curved corridor chords of one wall let a scanner turn by degrees, although what it sees
// agrees with the others as it is.
TEST(RigFindings, NoScannerIsTurnedFarWhoseViewAgrees) {
  CheckReport report = TwoScanners();
  report.rig->scanners[1].body_from_scanner.translation.x() = 0.1;
  report.agreements = {{0, 1, 500, 1.0, 0.005}};
  MountingCorrection& turned = report.corrections[1];
  turned.num_compared = 500;
  turned.near_share = 0.82;
  turned.moved_share = 0.92;
  turned.rotation_rad.z() = 0.08;
  turned.stddev.setConstant(0.001);
  FindRigFaults(&report);
  for (const Finding& finding : report.findings) {
    EXPECT_THAT(finding.sentence, testing::Not(HasSubstr("to be turned")));
  }
  turned.near_share = 0.4;
  report.findings.clear();
  FindRigFaults(&report);
  ASSERT_FALSE(report.findings.empty());
  EXPECT_EQ(report.findings.front().severity, Severity::kStop);
  EXPECT_THAT(report.findings.front().sentence, HasSubstr("to be turned by 4.6 deg"));
}

}  // namespace
}  // namespace plumbline
