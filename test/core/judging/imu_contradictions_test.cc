#include "core/judging/imu_contradictions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "core/judging/consistency.h"
#include "core/util/time.h"
#include "test/core/judging/corridor.h"
#include "test/core/judging/hand_made_map.h"

namespace plumbline {
namespace {

constexpr int kNumSeconds = 8;

// A rig that rests, and an IMU that reads a change of the vertical velocity at an instant,
// evenly within a tenth of a second.
class ImuContradictionsTest : public testing::Test {
 protected:
  ImuContradictionsTest() {
    imu_.gyroscope.noise = 1e-4;
    imu_.accelerometer.noise = 4e-3;
  }

  // actual_noise: of the accelerometer, by what the rig file states.
  void Read(double at_s, double velocity_m_s, double actual_noise = 1.0) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::vector<ImuSample> samples;
    for (int i = 0; i < 200 * (kNumSeconds + 2); ++i) {
      ImuSample sample;
      const double time_s = (i + 0.5) / 200.0;
      sample.time_ns = NanosecondsFromSeconds(time_s);
      sample.specific_force.z() = kStandardGravity;
      for (int axis = 0; axis < 3; ++axis) {
        sample.specific_force[axis] +=
            actual_noise * imu_.accelerometer.noise * std::sqrt(200.0) * normal(random);
        sample.angular_rate[axis] += imu_.gyroscope.noise * std::sqrt(200.0) * normal(random);
      }
      if (time_s >= at_s && time_s < at_s + 0.1) {
        sample.specific_force.z() += velocity_m_s / 0.1;
      }
      samples.push_back(sample);
    }
    map_.state().imu = std::make_shared<const ImuReadings>(samples, imu_);
    const double knot_interval_s = map_.state().trajectory.knot_interval_s();
    map_.state().calibration.imu.emplace(imu_, false, knot_interval_s);
    map_.state().calibration.imu->ExtendTo(map_.state().trajectory.num_control_points());
  }

  std::vector<ImuContradiction> Find() {
    return FindImuContradictions(map_.state(), kNumSeconds, 0);
  }

  ConsistencyReport Report() {
    Corridor corridor(&map_);
    for (int second = 0; second < kNumSeconds; ++second) corridor.See(second, true);
    const FinishedMap finished{
        true, map_.state(), 1.0, 0, std::vector<double>(kNumSeconds, 0.001)};
    return JudgeConsistency(map_.rig(), finished, ScannerActivity(1), 0);
  }

  Imu imu_;
  HandMadeMap map_;
};

TEST_F(ImuContradictionsTest, ARiseThatTheMapDoesNotHaveIsFound) {
  Read(4.3, 0.09);
  const std::vector<ImuContradiction> found = Find();
  ASSERT_EQ(found.size(), 3u);  // its second and both neighbours
  EXPECT_EQ(found[1].second, 4);
  EXPECT_TRUE(found[1].by_accelerometer);
  EXPECT_NEAR(found[1].difference_world.z(), -0.09, 0.03);
}

TEST_F(ImuContradictionsTest, OneBetweenTwoSecondsIsFound) {
  Read(3.95, 0.09);
  const std::vector<ImuContradiction> found = Find();
  ASSERT_GE(found.size(), 2u);
  EXPECT_NEAR(found[1].difference_world.z(), -0.09, 0.03);
}

TEST_F(ImuContradictionsTest, NoiseIsNone) {
  Read(0.0, 0.0);
  EXPECT_TRUE(Find().empty());
}

TEST_F(ImuContradictionsTest, NoiseThatIsStatedTooSmallIsNone) {
  Read(0.0, 0.0, 10.0);
  EXPECT_TRUE(Find().empty());
}

TEST_F(ImuContradictionsTest, NothingInThePlaneAndWithoutImu) {
  Read(4.3, 0.09);
  map_.state().calibration.imu->planar = true;
  EXPECT_TRUE(Find().empty());
  map_.state().imu = nullptr;
  EXPECT_TRUE(Find().empty());
}

TEST_F(ImuContradictionsTest, NothingBesideAGap) {
  Read(4.3, 0.09);
  map_.state().gaps.push_back(
      {NanosecondsFromSeconds(4.2), NanosecondsFromSeconds(4.5), "test"});
  EXPECT_TRUE(Find().empty());
}

TEST_F(ImuContradictionsTest, ItMakesTheMapDoubtfulAndNamesTheImu) {
  Read(4.3, 0.09);
  const ConsistencyReport report = Report();
  EXPECT_EQ(report.consistency.verdict, Verdict::kDoubtful);
  ASSERT_EQ(report.consistency.doubtful_intervals.size(), 1u);
  const DoubtfulInterval& doubt = report.consistency.doubtful_intervals.front();
  EXPECT_EQ(doubt.start_s, 3.0);
  EXPECT_EQ(doubt.end_s, 6.0);
  EXPECT_NE(doubt.reason.find("the accelerometer reads up to 0."), std::string::npos);
  EXPECT_NE(doubt.reason.find("vertical"), std::string::npos) << doubt.reason;
  ASSERT_TRUE(report.cause);
  EXPECT_EQ(report.cause->name, "the map contradicts the IMU");
}

TEST_F(ImuContradictionsTest, ASmallOneIsNoDoubt) {
  Read(4.3, 0.035);
  EXPECT_FALSE(Find().empty());
  EXPECT_EQ(Report().consistency.verdict, Verdict::kConsistent);
}

}  // namespace
}  // namespace plumbline
