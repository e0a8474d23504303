#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/judging/findings.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int64_t kStartNs = 1'600'000'000'000'000'000;

auto IsFinding(Severity severity, const std::string& subject, const std::string& text) {
  return AllOf(Field(&Finding::severity, severity),
               Field(&Finding::subject, subject),
               Field(&Finding::sentence, HasSubstr(text)));
}

// Two topics of ten lines a second, for ten seconds.
class TimingFindingsTest : public testing::Test {
 protected:
  TimingFindingsTest() {
    report_.survey.start_receipt_ns = kStartNs;
    report_.survey.end_receipt_ns = kStartNs + 9'900'000'000;
    for (const char* name : {"/a", "/b"}) {
      TopicSurvey topic;
      topic.name = name;
      topic.period_s = 0.1;
      topic.num_beams = 100;
      topic.angle_increment = 0.04;
      topic.time_increment_s = 6e-4;
      for (int64_t i = 0; i < 100; ++i) {
        const int64_t stamp_ns = kStartNs + i * 100'000'000;
        topic.stamps.push_back({stamp_ns, stamp_ns + 2'000'000});
      }
      report_.survey.topics.push_back(topic);
    }
  }
  TopicSurvey& first() { return report_.survey.topics[0]; }
  TopicSurvey& second() { return report_.survey.topics[1]; }
  static void Cut(TopicSurvey* topic, size_t begin, size_t end) {
    topic->stamps.erase(topic->stamps.begin() + static_cast<std::ptrdiff_t>(begin),
                        topic->stamps.begin() + static_cast<std::ptrdiff_t>(end));
  }
  const std::vector<Finding>& Find() {
    FindTimingFaults(&report_);
    return report_.findings;
  }

  CheckReport report_;
};

TEST_F(TimingFindingsTest, GoodStampsAreNotFound) { EXPECT_THAT(Find(), IsEmpty()); }

TEST_F(TimingFindingsTest, AGapOfOneTopic) {
  Cut(&first(), 20, 50);
  EXPECT_THAT(Find(),
              ElementsAre(IsFinding(
                  Severity::kWarning, "/a", "sends nothing for 3.1 s, from 1.9 s on")));
}

TEST_F(TimingFindingsTest, AGapOfAllTopicsIsToldOnce) {
  Cut(&first(), 20, 50);
  Cut(&second(), 20, 50);
  EXPECT_THAT(Find(),
              ElementsAre(IsFinding(
                  Severity::kWarning, "", "no scanner sends anything from 1.9 to 5.0 s")));
}

TEST_F(TimingFindingsTest, SingleLinesAreMissing) {
  for (size_t i = 90; i > 10; i -= 10) Cut(&first(), i, i + 1);
  EXPECT_THAT(Find(), ElementsAre(IsFinding(Severity::kWarning, "/a", "about 8 %")));
}

TEST_F(TimingFindingsTest, WhatTheMapperPassesOverIsNamed) {
  first().passed_over.jumped.count = 7;
  first().passed_over.repeated.count = 1;
  second().passed_over.apart = {2, 0};
  EXPECT_THAT(
      Find(),
      ElementsAre(IsFinding(Severity::kWarning, "/a", "1 scan line has the stamp of"),
                  IsFinding(Severity::kWarning, "/a", "7 scan lines have stamps that jump"),
                  IsFinding(Severity::kWarning, "/b", "such as 1970-01-01 00:00:00 UTC")));
}

TEST_F(TimingFindingsTest, LinesThatComeOutOfTurnAreNoted) {
  first().num_out_of_turn = 12;
  EXPECT_THAT(Find(),
              ElementsAre(IsFinding(Severity::kNote, "/a", "12 scan lines came after")));
}

TEST_F(TimingFindingsTest, AClockThatIsSet) {
  for (size_t i = 50; i < 100; ++i) first().stamps[i].stamp_ns += 700'000'000;
  EXPECT_THAT(Find(),
              Contains(IsFinding(Severity::kWarning, "/a", "1 time, by 0.70 s, at 5.0 s")));
}

TEST_F(TimingFindingsTest, StampsThatDoNotCountUp) {
  first().stamps.resize(1);
  first().passed_over.repeated.count = 99;
  EXPECT_THAT(Find(), Contains(IsFinding(Severity::kStop, "/a", "do not count up")));
}

TEST_F(TimingFindingsTest, ClocksApart) {
  for (LineStamp& stamp : second().stamps) stamp.stamp_ns -= 5'000'000'000;
  EXPECT_THAT(Find(),
              ElementsAre(IsFinding(Severity::kStop, "/b", "5.00 s behind those of /a")));
}

TEST_F(TimingFindingsTest, BeamTimesThatCanNotBe) {
  first().time_increment_s = 0.0;
  second().time_increment_s = 2e-3;
  EXPECT_THAT(Find(),
              ElementsAre(IsFinding(Severity::kWarning, "/a", "time_increment is 0"),
                          IsFinding(Severity::kWarning, "/b", "would take 200.0 ms")));
}

TEST_F(TimingFindingsTest, ATopicThatIsNearlyEmpty) {
  first().stamps.resize(2);
  EXPECT_THAT(Find(), Contains(IsFinding(Severity::kStop, "/a", "only 2 scan lines")));
}

TEST_F(TimingFindingsTest, ATopicThatStopsEarly) {
  Cut(&first(), 50, 100);
  EXPECT_THAT(Find(), ElementsAre(IsFinding(Severity::kWarning, "/a", "ends 5.0 s before")));
}

TEST_F(TimingFindingsTest, ScannersThatShareATopic) {
  first().frames = {"front", "rear"};
  second().num_compared = 98;
  second().num_alternating = 90;
  const std::vector<Finding> findings = Find();
  EXPECT_THAT(
      findings,
      ElementsAre(IsFinding(Severity::kStop,
                            "/a",
                            "of 2 scanners, by the frames in "
                            "their headers: front and rear"),
                  IsFinding(Severity::kStop, "/b", "two scanners that take turns: 92 %")));
  EXPECT_TRUE(findings[0].moves_places);
}

TEST_F(TimingFindingsTest, WhatThereIsInsteadOfScanLinesIsToldOnce) {
  first().stamps.clear();
  first().num_off_plane = 7;
  first().frames = {"base_link"};
  second().stamps.clear();
  second().passed_over.unusable.count = 9;
  second().unusable_reason = "time_increment is 3 s";
  EXPECT_THAT(Find(),
              ElementsAre(IsFinding(Severity::kStop, "/a", "z = 0 in their frame base_link"),
                          IsFinding(Severity::kStop, "/b", "time_increment is 3 s")));
}

}  // namespace
}  // namespace plumbline
