#include "core/sensor/odometry_repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>

#include "core/util/time.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kPeriod = 0.1;  // s

// Where a rig is that drives to and fro along a bend, and what it says of its velocity.
CountedPose PoseAt(double time_s) {
  const double speed = 0.4 * std::sin(0.5 * time_s);
  const double way = 0.8 * (1.0 - std::cos(0.5 * time_s));
  const double heading = 2.0 + 0.3 * way;
  const Eigen::Vector2d position(std::sin(heading) / 0.3, -std::cos(heading) / 0.3);
  return {{NanosecondsFromSeconds(100.0 + time_s), position, heading}, {speed, 0.0}};
}

std::vector<CountedPose> Drive() {
  std::vector<CountedPose> poses;
  for (int i = 0; i < 300; ++i) poses.push_back(PoseAt(kPeriod * i));
  return poses;
}

// As a driver counts that takes each step for one ahead.
std::vector<CountedPose> DriveWithoutSigns() {
  const std::vector<CountedPose> poses = Drive();
  std::vector<CountedPose> counted = poses;
  for (size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Vector2d step = poses[i].sample.position - poses[i - 1].sample.position;
    const double heading = 0.5 * (poses[i].sample.heading + poses[i - 1].sample.heading);
    const bool is_ahead =
        step.dot(Eigen::Vector2d(std::cos(heading), std::sin(heading))) > 0.0;
    counted[i].sample.position =
        counted[i - 1].sample.position + (is_ahead ? 1.0 : -1.0) * step;
  }
  return counted;
}

double LargestError(const std::vector<OdometrySample>& samples) {
  double largest = 0.0;
  for (const OdometrySample& sample : samples) {
    const double time_s = SecondsBetween(NanosecondsFromSeconds(100.0), sample.time_ns);
    const Eigen::Vector2d true_position = PoseAt(time_s).sample.position;
    largest = std::max(largest, (sample.position - true_position).norm());
  }
  return largest;
}

TEST(OdometryRepair, GoodWheelsStayAsTheyAre) {
  std::vector<std::string> sentences;
  const auto samples = RepairOdometry(Drive(), &sentences);
  EXPECT_EQ(samples.size(), 300U);
  EXPECT_LT(LargestError(samples), 1e-12);
  EXPECT_THAT(sentences, IsEmpty());
}

TEST(OdometryRepair, StepsThatLackTheirSignAreTurnedRound) {
  std::vector<std::string> sentences;
  const auto samples = RepairOdometry(DriveWithoutSigns(), &sentences);
  EXPECT_LT(LargestError(samples), 0.01);  // steps about a standstill may have either sign
  EXPECT_THAT(sentences, ElementsAre(HasSubstr("turned round")));
}

TEST(OdometryRepair, WithoutVelocitiesNothingIsSaidOfSigns) {
  std::vector<CountedPose> poses = DriveWithoutSigns();
  for (CountedPose& pose : poses) pose.velocity.setZero();
  std::vector<std::string> sentences;
  EXPECT_GT(LargestError(RepairOdometry(poses, &sentences)), 1.0);
  EXPECT_THAT(sentences, IsEmpty());
}

// Some drivers state the velocity in the frame of the pose: a rig that looks the other way
// goes forward with a negative one.
TEST(OdometryRepair, VelocitiesInTheFrameOfThePoseSayNothingOfSigns) {
  std::vector<CountedPose> poses;
  for (int i = 0; i < 100; ++i) {
    poses.push_back(
        {{NanosecondsFromSeconds(kPeriod * i), {-0.04 * i, 0.01 * i}, 2.9}, {-0.4, 0.1}});
  }
  std::vector<std::string> sentences;
  const auto samples = RepairOdometry(poses, &sentences);
  EXPECT_NEAR(samples.back().position.x(), -0.04 * 99, 1e-12);
  EXPECT_THAT(sentences, IsEmpty());
}

TEST(OdometryRepair, PosesSentAgainWhileTheRigMovesAreLeftOut) {
  std::vector<CountedPose> poses = Drive();
  for (const size_t i : {20U, 45U, 46U, 110U}) {
    poses[i].sample.position = poses[i - 1].sample.position;
    poses[i].sample.heading = poses[i - 1].sample.heading;
  }
  std::vector<std::string> sentences;
  const auto samples = RepairOdometry(poses, &sentences);
  EXPECT_EQ(samples.size(), 296U);
  EXPECT_LT(LargestError(samples), 1e-12);
  EXPECT_THAT(sentences, ElementsAre(HasSubstr("4 poses were sent again")));
}

// The pose is sent again just where a turn on the spot begins, so that no step is like
// another.
TEST(OdometryRepair, PosesSentAgainWhileATurnBeginsAreLeftOut) {
  const double rates[] = {0.0, 0.0, 0.1, 0.3, 0.7, 1.2, 1.6, 1.7, 1.7, 1.7};  // rad/s
  for (const size_t stale : {4U, 5U, 6U}) {
    std::vector<CountedPose> poses;
    CountedPose pose;
    for (size_t i = 0; i < std::size(rates); ++i) {
      pose.sample.time_ns = NanosecondsFromSeconds(kPeriod * static_cast<double>(i));
      pose.sample.position.x() += 0.3 * kPeriod;
      pose.sample.heading += rates[i] * kPeriod;
      poses.push_back(pose);
    }
    poses[stale].sample.position = poses[stale - 1].sample.position;
    poses[stale].sample.heading = poses[stale - 1].sample.heading;
    std::vector<std::string> sentences;
    EXPECT_EQ(RepairOdometry(poses, &sentences).size(), 9U) << stale;
  }
}

TEST(OdometryRepair, ARigThatStopsAndGoesOnHasStopped) {
  std::vector<CountedPose> poses;
  for (int i = 0; i < 60; ++i) {
    const int moved = i < 20 ? i : std::max(20, i - 20);
    poses.push_back({{NanosecondsFromSeconds(kPeriod * i), {0.05 * moved, 0.0}, 0.0},
                     Eigen::Vector2d::Zero()});
  }
  std::vector<std::string> sentences;
  EXPECT_EQ(RepairOdometry(poses, &sentences).size(), 60U);
  EXPECT_THAT(sentences, IsEmpty());
}

}  // namespace
}  // namespace plumbline
