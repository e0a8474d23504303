#include "core/judging/wheel_slips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "core/judging/consistency.h"
#include "core/util/time.h"
#include "test/core/judging/corridor.h"
#include "test/core/judging/hand_made_map.h"

namespace plumbline {
namespace {

// A rig that rests in a corridor whose end is out of sight from 2 to 6 s, and wheels that
// count a way from one instant to another, evenly.
class WheelSlipsTest : public testing::Test {
 protected:
  void Count(double from_s, double to_s, double way_m, int num_seconds = 8) {
    for (int second = 0; second < num_seconds; ++second) {
      corridor_.See(second, second < 2 || second >= 6);
    }
    std::vector<OdometrySample> samples;
    for (double at_s = 0.0; at_s <= 10.0; at_s += 0.02) {
      const double share = std::clamp((at_s - from_s) / (to_s - from_s), 0.0, 1.0);
      samples.push_back({NanosecondsFromSeconds(at_s), {share * way_m, 0.0}, 0.0});
    }
    map_.state().odometry = std::make_shared<const Odometry>(samples);
    map_.state().odometry_calibration = OdometryCalibration(OdometryOptions());
  }

  std::vector<WheelSlip> Find() {
    const auto strengths = StrengthOverTime(map_.rig(), true, map_.state(), 0);
    return FindWheelSlips(map_.state(), strengths, DegenerateIntervals(strengths), 0);
  }

  ConsistencyReport Report() {
    const FinishedMap finished{true, map_.state(), 1.0, 0, std::vector<double>(8, 0.001)};
    return JudgeConsistency(map_.rig(), finished, ScannerActivity(1), 0);
  }

  HandMadeMap map_;
  Corridor corridor_{&map_};
};

TEST_F(WheelSlipsTest, ASlipWhileTheEndIsOutOfSightIsFound) {
  Count(3.0, 3.3, 0.15);
  const std::vector<WheelSlip> slips = Find();
  ASSERT_EQ(slips.size(), 1u);
  EXPECT_EQ(slips[0].start_s, 2.0);
  EXPECT_EQ(slips[0].end_s, 6.0);
  EXPECT_NEAR(slips[0].sum_m, 0.15, 1e-6);
}

// No single interval tells: spread evenly it is 5 mm an eighth of a second.
TEST_F(WheelSlipsTest, ASlipSpreadEvenlyIsFound) {
  Count(2.0, 6.0, 0.15);
  ASSERT_EQ(Find().size(), 1u);
}

TEST_F(WheelSlipsTest, OneWhileTheEndIsInSightIsNone) {
  Count(0.5, 0.8, 0.15);
  EXPECT_TRUE(Find().empty());
}

TEST_F(WheelSlipsTest, NoiseIsNone) {
  Count(3.0, 4.0, 0.01);
  EXPECT_TRUE(Find().empty());
}

// The end never comes into view again: nothing contradicts the wheels.
TEST_F(WheelSlipsTest, OneAtTheMapsEndIsNone) {
  Count(3.0, 3.3, 0.15, 6);
  EXPECT_TRUE(Find().empty());
}

TEST_F(WheelSlipsTest, ItMakesTheMapDoubtfulAndNamesTheWheels) {
  Count(3.0, 3.3, 0.15);
  const ConsistencyReport report = Report();
  EXPECT_EQ(report.consistency.verdict, Verdict::kDoubtful);
  ASSERT_EQ(report.consistency.doubtful_intervals.size(), 1u);
  const DoubtfulInterval& doubt = report.consistency.doubtful_intervals.front();
  EXPECT_EQ(doubt.start_s, 2.0);
  EXPECT_EQ(doubt.end_s, 6.0);
  EXPECT_NE(doubt.reason.find("the wheels count 0.15 m"), std::string::npos) << doubt.reason;
  ASSERT_TRUE(report.cause);
  EXPECT_NE(report.cause->name.find("wheels"), std::string::npos);
}

TEST_F(WheelSlipsTest, AShortOneIsNoDoubt) {
  Count(3.0, 3.3, 0.04);
  EXPECT_EQ(Report().consistency.verdict, Verdict::kConsistent);
}

}  // namespace
}  // namespace plumbline
