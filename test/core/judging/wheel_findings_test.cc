#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/judging/findings.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int64_t kStartNs = 1'600'000'000'000'000'000;

double HeadingAt(double time_s) {
  return 1.2 * std::sin(0.9 * time_s) + 0.4 * std::sin(2.3 * time_s);
}

// A level scanner that sees the rig turn to and fro for 30 s, and what the wheels say of it.
class WheelFindingsTest : public testing::Test {
 protected:
  WheelFindingsTest() {
    Scanner scanner;
    scanner.topic = "/scan";
    report_.rig = Rig();
    report_.rig->scanners = {scanner};
    report_.rig->odometry_topic = "/odom";
    report_.topics_of_scanners = {0};
    report_.heights.resize(1);
    report_.turns.emplace_back();
    for (double time_s = 0.0; time_s < 30.0; time_s += 0.5) {
      report_.turns[0].push_back({kStartNs + NanosecondsFromSeconds(time_s),
                                  kStartNs + NanosecondsFromSeconds(time_s + 0.5),
                                  HeadingAt(time_s) - HeadingAt(time_s + 0.5)});
    }
  }
  // The sentences about wheels whose heading is that at their stamp.
  std::vector<std::string> Find(const std::function<double(double)>& heading,
                                double start_s = -2.0) {
    std::vector<OdometrySample> samples;
    for (double time_s = start_s; time_s < start_s + 34.0; time_s += 0.02) {
      samples.push_back(
          {kStartNs + NanosecondsFromSeconds(time_s), {0.1 * time_s, 0.0}, heading(time_s)});
    }
    report_.survey.wheels = std::make_shared<const Odometry>(samples);
    FindWheelFaults(&report_);
    std::vector<std::string> sentences;
    for (const Finding& finding : report_.findings) {
      sentences.push_back(finding.sentence + "; " + finding.advice);
    }
    return sentences;
  }

  CheckReport report_;
};

TEST_F(WheelFindingsTest, GoodWheelsAreNotFound) {
  EXPECT_THAT(Find([](double time_s) { return 1.05 * HeadingAt(time_s) + 0.3; }), IsEmpty());
}

TEST_F(WheelFindingsTest, AScannerUpsideDownSeesTurnsTheOtherWay) {
  report_.rig->scanners[0].body_from_scanner.rotation =
      Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX());
  for (StepTurn& turn : report_.turns[0]) turn.turn_rad = -turn.turn_rad;
  EXPECT_THAT(Find(HeadingAt), IsEmpty());
}

TEST_F(WheelFindingsTest, WheelsThatTurnTheOtherWay) {
  EXPECT_THAT(Find([](double time_s) { return -HeadingAt(time_s); }),
              ElementsAre(HasSubstr("turn the other way round")));
}

TEST_F(WheelFindingsTest, TheClockIsFoundWhereItIsNotStated) {
  EXPECT_THAT(Find([](double time_s) { return HeadingAt(time_s + 0.13); }),
              ElementsAre(HasSubstr("about 0.13 s too early")));
  ASSERT_TRUE(report_.wheels_late_s);
  EXPECT_NEAR(*report_.wheels_late_s, -0.13, 0.011);
  EXPECT_EQ(report_.findings[0].severity, Severity::kNote);
}

TEST_F(WheelFindingsTest, WhatWasMendedIsTold) {
  report_.survey.wheels_mended = {"3 poses were sent again"};
  EXPECT_THAT(Find(HeadingAt), ElementsAre(HasSubstr("of the wheels 3 poses")));
  EXPECT_TRUE(report_.findings[0].is_told_by_reader);
}

TEST_F(WheelFindingsTest, WheelsThatAreLate) {
  report_.rig->odometry_time_offset_s = 0.0;
  EXPECT_THAT(Find([](double time_s) { return HeadingAt(time_s - 0.4); }),
              ElementsAre(testing::AllOf(HasSubstr("about 0.40 s too late"),
                                         HasSubstr("time_offset_s: -0.40"))));
}

TEST_F(WheelFindingsTest, WheelsThatDoNotTurn) {
  EXPECT_THAT(Find([](double) { return 0.0; }), ElementsAre(HasSubstr("do not turn as")));
}

TEST_F(WheelFindingsTest, WheelsOfAnotherClock) {
  EXPECT_THAT(Find(HeadingAt, 5000.0), ElementsAre(HasSubstr("of another clock")));
}

TEST_F(WheelFindingsTest, WheelsThatSayNothing) {
  report_.survey.wheels_fault = "its pose never changes";
  EXPECT_THAT(Find(HeadingAt), ElementsAre(HasSubstr("left out: its pose never changes")));
}

}  // namespace
}  // namespace plumbline
