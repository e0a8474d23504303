#include "core/sensor/mount.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr int64_t kStep = 20'000'000;  // ns
const double kFrequency = 2.0 * M_PI;  // rad/s

double Angle(int64_t time_ns) {
  return 0.5 * std::sin(kFrequency * SecondsBetween(0, time_ns));
}

// A swing of half a radian at 1 Hz, read at 50 Hz.
std::vector<JointSample> Samples(int count) {
  std::vector<JointSample> samples;
  for (int i = 0; i < count; ++i) samples.push_back({i * kStep, Angle(i * kStep)});
  return samples;
}

TEST(JointAnglesTest, FollowASwingBetweenItsReadings) {
  const JointAngles angles(Samples(101));
  for (int64_t time_ns = 100'000'000; time_ns < 1'900'000'000; time_ns += 1'700'000) {
    const MountAngle at = angles.At(time_ns);
    const double t = kFrequency * SecondsBetween(0, time_ns);
    EXPECT_NEAR(at.angle_rad, Angle(time_ns), 0.001 * M_PI / 180.0);
    EXPECT_NEAR(at.rate_rad_s, 0.5 * kFrequency * std::cos(t), 0.02);
    const double step_s = 1e-5;
    const int64_t step_ns = NanosecondsFromSeconds(step_s);
    EXPECT_NEAR(
        (angles.At(time_ns + step_ns).angle_rad - angles.At(time_ns - step_ns).angle_rad) /
            (2.0 * step_s),
        at.rate_rad_s,
        1e-3);
  }
}

TEST(JointAnglesTest, TakeReadingsInAnyOrderOnceEachAndTurnOn) {
  std::vector<JointSample> samples;
  // A turn in half a second, read within +-pi.
  for (int i = 0; i < 50; ++i) {
    samples.push_back({i * kStep, std::remainder(0.25 * i, 2.0 * M_PI)});
  }
  samples.push_back({3 * kStep, 2.0});
  samples.push_back({60 * kStep, std::numeric_limits<double>::quiet_NaN()});
  std::swap(samples[4], samples[20]);
  const JointAngles angles(samples);
  EXPECT_EQ(angles.size(), 50u);
  EXPECT_NEAR(angles.At(40 * kStep + kStep / 2).angle_rad, 0.25 * 40.5, 1e-9);
  EXPECT_NEAR(angles.At(51 * kStep).angle_rad, 0.25 * 51, 1e-9) << "goes on at its last rate";
}

TEST(JointAnglesTest, SayWhereTheyTellNothing) {
  std::vector<JointSample> samples = Samples(50);
  samples.erase(samples.begin() + 20, samples.begin() + 30);
  const JointAngles angles(samples);
  EXPECT_TRUE(angles.Covers(10 * kStep + 5));
  EXPECT_FALSE(angles.Covers(25 * kStep));
  EXPECT_FALSE(angles.Covers(70 * kStep));
  EXPECT_TRUE(angles.Covers(40 * kStep));
  EXPECT_NEAR(angles.longest_gap_s(), 0.22, 1e-9);
  EXPECT_FALSE(JointAngles({}).Covers(0));
  EXPECT_EQ(angles.Fault(), "");
  EXPECT_EQ(JointAngles({}).Fault(), "it has no readings");
  EXPECT_EQ(JointAngles({{0, 1.0}, {kStep, 1.0}}).Fault(), "its angle never changes");
}

TEST(MountTest, TurnsByAConstantRate) {
  Mount mount;
  mount.start_ns = 5'000'000'000;
  mount.rate_rad_s = 3.0;
  mount.zero_rad = 0.1;
  mount.time_offset_s = 0.01;
  EXPECT_NEAR(mount.AngleAt(7'000'000'000, 0.0), 0.1 + 3.0 * 1.99, 1e-9);
  mount.rate_excess = 0.01;
  mount.delay_s = 0.02;
  EXPECT_NEAR(mount.AngleAt(7'000'000'000, 0.0), 0.1 + 3.0 * (1.99 + 0.02 - 0.02), 1e-9);
  EXPECT_NEAR(mount.AngleAt(7'000'000'000, 0.5), 0.1 + 3.0 * (2.49 + 0.02 - 0.02), 1e-9);
}

TEST(MountTest, SwingsAboutItsZero) {
  Mount mount;
  mount.swing = Swing{0.5, 1.0, 0.0};
  mount.zero_rad = 0.1;
  EXPECT_NEAR(mount.AngleAt(0, 0.0), 0.1, 1e-12);
  EXPECT_NEAR(mount.AngleAt(250'000'000, 0.0), 0.6, 1e-12);
  EXPECT_NEAR(mount.StatedAt(0, 0.0).rate_rad_s, M_PI, 1e-12);
}

TEST(MountTest, LeavesItsAxisWhereItIs) {
  Mount mount;
  mount.axis = Eigen::Vector3d(1.0, 2.0, -1.0).normalized();
  mount.point = Eigen::Vector3d(0.3, -0.2, 0.1);
  const Rigid3d turn = mount.TurnBy(1.2);
  EXPECT_LT((turn * mount.point - mount.point).norm(), 1e-12);
  const Eigen::Vector3d along = mount.point + 2.0 * mount.axis;
  EXPECT_LT((turn * along - along).norm(), 1e-12);
  EXPECT_NEAR(turn.rotation.angularDistance(Eigen::Quaterniond::Identity()), 1.2, 1e-12);
}

TEST(MountTest, WithoutItsAnglesItStandsAtZero) {
  Mount mount;
  mount.joint_topic = "/joint_states";
  mount.zero_rad = 0.3;
  EXPECT_EQ(mount.AngleAt(1'000'000'000, 0.0), 0.3);
}

}  // namespace
}  // namespace plumbline
