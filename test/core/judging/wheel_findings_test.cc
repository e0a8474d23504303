#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/geometry/planar_pose.h"
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
    report_.moves.emplace_back();
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
    return Judge(samples);
  }
  std::vector<std::string> Judge(const std::vector<OdometrySample>& samples) {
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

// A rig drives half a circle to the left, at half a metre a second. Its scanner stands upside
// down, off the middle, and looks to the side.
class WheelWaysTest : public WheelFindingsTest {
 protected:
  static constexpr double kSpeed = 0.5;     // m/s
  static constexpr double kTurnRate = 0.1;  // rad/s

  WheelWaysTest() {
    report_.survey.start_receipt_ns = kStartNs;
    report_.turns[0].clear();
    Rigid3d& body_from_scanner = report_.rig->scanners[0].body_from_scanner;
    body_from_scanner = {RotationFromRollPitchYaw(M_PI, 0.0, 1.2), {0.4, -0.1, 0.2}};
    for (double time_s = 0.0; time_s < 30.0; time_s += 0.5) {
      const Rigid3d move = body_from_scanner.Inverse() * BodyAt(time_s).Inverse() *
                           BodyAt(time_s + 0.5) * body_from_scanner;
      report_.moves[0].push_back({kStartNs + NanosecondsFromSeconds(time_s),
                                  kStartNs + NanosecondsFromSeconds(time_s + 0.5),
                                  move.translation.head<2>(),
                                  FromAbove(move).heading});
    }
  }

  static Rigid3d BodyAt(double time_s) {
    const double heading = kTurnRate * time_s;
    return {
        RotationFromRollPitchYaw(0.0, 0.0, heading),
        kSpeed / kTurnRate * Eigen::Vector3d(std::sin(heading), 1.0 - std::cos(heading), 0.0)};
  }

  // The sentences about wheels that count so many times the way.
  std::vector<std::string> FindWays(const std::function<double(double)>& scale) {
    std::vector<OdometrySample> samples;
    Eigen::Vector2d position = Eigen::Vector2d::Zero();
    for (double time_s = -2.0; time_s < 32.0; time_s += 0.02) {
      const Rigid3d body = BodyAt(time_s);
      samples.push_back(
          {kStartNs + NanosecondsFromSeconds(time_s), position, FromAbove(body).heading});
      position +=
          scale(time_s) * (BodyAt(time_s + 0.02).translation - body.translation).head<2>();
    }
    return Judge(samples);
  }
};

TEST_F(WheelWaysTest, GoodWheelsAreNotFound) {
  EXPECT_THAT(FindWays([](double) { return 1.05; }), IsEmpty());
}

TEST_F(WheelWaysTest, WheelsThatCountTheWayBack) {
  EXPECT_THAT(FindWays([](double) { return -1.05; }),
              ElementsAre(testing::AllOf(HasSubstr("way ahead as a way back"),
                                         HasSubstr("body_from_scanner by 180"))));
  EXPECT_EQ(report_.findings[0].severity, Severity::kStop);
  EXPECT_EQ(report_.findings[0].subject, "/odom");
}

TEST_F(WheelWaysTest, WheelsThatCountPartsOfTheWayBack) {
  const auto scale = [](double time_s) { return time_s > 12.0 && time_s < 14.5 ? -1.0 : 1.0; };
  EXPECT_THAT(
      FindWays(scale),
      ElementsAre(HasSubstr("from 12 to 15 s the wheels count the way with the wrong")));
}

// Walls that are taken for one another show a move that was none.
TEST_F(WheelWaysTest, SingleMovesProveNothing) {
  for (size_t i = 0; i < report_.moves[0].size(); i += 3) {
    report_.moves[0][i].move = -report_.moves[0][i].move;
  }
  EXPECT_THAT(FindWays([](double) { return 1.0; }), IsEmpty());
}

TEST_F(WheelWaysTest, WheelsThatStandDoNotCountBack) {
  const auto scale = [](double time_s) { return time_s > 12.0 && time_s < 15.0 ? 0.0 : 1.0; };
  EXPECT_THAT(FindWays(scale), IsEmpty());
}

TEST_F(WheelWaysTest, WheelsOfAnotherUnit) {
  EXPECT_THAT(FindWays([](double) { return 0.001; }),
              ElementsAre(HasSubstr("do not go where the scanners see the rig go")));
}

}  // namespace
}  // namespace plumbline
