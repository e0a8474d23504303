#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/judging/findings.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

auto IsFinding(Severity severity, const std::string& text) {
  return AllOf(Field(&Finding::severity, severity),
               Field(&Finding::sentence, HasSubstr(text)));
}

// A topic of ten good seconds, and a rig file that fits it.
class RangeFindingsTest : public testing::Test {
 protected:
  RangeFindingsTest() {
    TopicSurvey topic;
    topic.name = "/scan";
    topic.num_beams = 100;
    topic.angle_increment = 0.04;
    topic.num_ranges = 10'000;
    topic.num_returns = 10'000;
    topic.noise_m = 0.03;
    topic.beams.assign(100, {100, 100, 0, 0.0F, 0});
    for (int64_t i = 0; i < 10; ++i) topic.seconds.push_back({10, 0, 1000, 1000, 900, 800, i});
    report_.survey.topics.push_back(topic);
    Scanner scanner;
    scanner.name = "one";
    report_.rig = Rig();
    report_.rig->scanners = {scanner};
    report_.topics_of_scanners = {0};
  }
  TopicSurvey& topic() { return report_.survey.topics[0]; }
  const std::vector<Finding>& Find() {
    FindRangeFaults(&report_);
    return report_.findings;
  }

  CheckReport report_;
};

TEST_F(RangeFindingsTest, AGoodScannerIsNotFound) { EXPECT_THAT(Find(), IsEmpty()); }

TEST_F(RangeFindingsTest, ADeadScanner) {
  topic().num_returns = 0;
  topic().num_infinite = 10'000;
  EXPECT_THAT(Find(), ElementsAre(IsFinding(Severity::kStop, "dead")));
}

TEST_F(RangeFindingsTest, Millimetres) {
  topic().metres_per_unit = 1e-3;
  topic().histogram.assign(450, 0);
  topic().histogram[320] = 1;
  EXPECT_THAT(Find(), ElementsAre(IsFinding(Severity::kStop, "millimetres")));
}

TEST_F(RangeFindingsTest, AFrozenScanner) {
  topic().seconds[4].num_repeated = topic().seconds[5].num_repeated = 10;
  EXPECT_THAT(Find(), ElementsAre(IsFinding(Severity::kWarning, "ranges from 4 to 6 s")));
}

TEST_F(RangeFindingsTest, ASilentScanner) {
  topic().seconds[4].num_returns = topic().seconds[5].num_returns = 0;
  EXPECT_THAT(Find(),
              ElementsAre(IsFinding(Severity::kWarning, "next to nothing from 4 to 6 s")));
}

TEST_F(RangeFindingsTest, AScannerThatReturnsNoise) {
  topic().seconds[4].num_straight = topic().seconds[5].num_straight = 30;
  EXPECT_THAT(Find(),
              ElementsAre(IsFinding(Severity::kWarning, "from beam to beam from 4 to 6 s")));
}

TEST_F(RangeFindingsTest, MoreNoiseThanTheRigFileSays) {
  topic().noise_m = 0.06;
  EXPECT_THAT(Find(),
              ElementsAre(IsFinding(Severity::kWarning, "60 mm, the rig file says 30 mm")));
}

TEST_F(RangeFindingsTest, TheRigInView) {
  for (size_t beam = 10; beam < 20; ++beam) topic().beams[beam].num_near = 95;
  EXPECT_THAT(Find(),
              ElementsAre(IsFinding(Severity::kNote, "from 23 to 44 deg: the rig itself")));
}

TEST_F(RangeFindingsTest, ABlindSector) {
  for (size_t beam = 10; beam < 20; ++beam) topic().beams[beam].num_returns = 0;
  EXPECT_THAT(Find(),
              ElementsAre(IsFinding(Severity::kNote, "never has a return from 23 to 44")));
}

}  // namespace
}  // namespace plumbline
