#include "core/trajectory/motion_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "factors/spline/so3.h"

namespace plumbline {
namespace {

constexpr int64_t kKnotInterval = 50'000'000;  // ns
constexpr double kIntervalS = 0.05;

ControlPoint Standing() { return ControlPoint(); }

// A rig that stands but for one control point.
Trajectory WithOne(int index, const ControlPoint& control_point, int num_control_points) {
  Trajectory trajectory(0, kKnotInterval, Rigid3d());
  trajectory.ExtendTo((num_control_points - 4) * kKnotInterval);
  for (int i = 0; i < trajectory.num_control_points(); ++i) {
    trajectory.control_point(i) = Standing();
  }
  trajectory.control_point(index) = control_point;
  return trajectory;
}

MotionNoise Ones() {
  MotionNoise noise;
  noise.density.fill(1.0);
  return noise;
}

TEST(MotionNoise, AccelerationsByHand) {
  ControlPoint moved;
  moved.position = {0.01, 0.0, -0.02};
  Eigen::Map<Eigen::Quaterniond>(moved.rotation.data()) = Exp(Eigen::Vector3d(0.0, 0.03, 0.0));
  const Trajectory trajectory = WithOne(2, moved, 8);
  const KnotAcceleration after = KnotAcceleration::At(trajectory, 2);
  EXPECT_LT((after.linear_world - Eigen::Vector3d(4.0, 0.0, -8.0)).norm(), 1e-9);
  EXPECT_LT((after.angular_world - Eigen::Vector3d(0.0, 12.0, 0.0)).norm(), 1e-9);
  const KnotAcceleration at = KnotAcceleration::At(trajectory, 1);
  EXPECT_LT((at.linear_world - Eigen::Vector3d(-8.0, 0.0, 16.0)).norm(), 1e-9);
  EXPECT_LT((at.angular_world - Eigen::Vector3d(0.0, -24.0, 0.0)).norm(), 1e-9);
  EXPECT_EQ(KnotAcceleration::At(trajectory, 3).linear_world, Eigen::Vector3d::Zero());
}

// The same motion has the same noise whatever the knots: white noise of density q has the
// variance q^2 / h over an interval h.
TEST(MotionNoise, StandardDeviationsFollowTheKnots) {
  const MotionNoise noise = Ones();
  EXPECT_NEAR(noise.LinearStddev(0.04).x(), 5.0, 1e-12);
  EXPECT_NEAR(noise.AngularStddev(0.16).z(), 2.5, 1e-12);
}

// Correlated over a quarter of a second, accelerations at fine knots and at coarse ones have
// the same spectral density at low frequencies: h times the sum of their covariances at all
// lags, which for persistence rho is variance (1 + rho) / (1 - rho).
TEST(MotionNoise, CorrelatedAccelerationsFollowTheKnots) {
  MotionNoise noise = Ones();
  noise.correlation_s = 0.25;
  for (const double h : {0.01, 0.05, 0.2, 1.0}) {
    const double rho = noise.Persistence(h);
    EXPECT_NEAR(rho, std::exp(-4.0 * h), 1e-12);
    const double variance = std::pow(noise.LinearStddev(h).x(), 2);
    EXPECT_NEAR(h * variance * (1.0 + rho) / (1.0 - rho), 1.0, 1e-12);
    // What goes on and what is new make up what there is.
    EXPECT_NEAR(rho * rho * variance + std::pow(noise.LinearInnovationStddev(h).x(), 2),
                variance,
                1e-12 * variance);
    EXPECT_EQ(noise.AngularStddev(h).z(), noise.LinearStddev(h).x());
    EXPECT_EQ(noise.AngularInnovationStddev(h).z(), noise.LinearInnovationStddev(h).x());
  }
  // Between knots that are much finer the acceleration is that of a process of variance
  // density^2 / (2 correlation time).
  EXPECT_NEAR(std::pow(noise.LinearStddev(1e-3).x(), 2), 1.0 / 0.5, 1e-4);
}

TEST(MotionNoise, InnovationsByHand) {
  ControlPoint moved;
  moved.position = {0.01, 0.0, 0.0};
  const Trajectory trajectory = WithOne(2, moved, 8);
  // Accelerations of 4, -8 and 4 m/s^2.
  MotionNoise noise = Ones();
  noise.correlation_s = kIntervalS / std::log(2.0);  // half of an acceleration goes on
  EXPECT_NEAR(noise.InnovationAt(trajectory, 0).linear_world.x(), -8.0 - 2.0, 1e-9);
  EXPECT_NEAR(noise.InnovationAt(trajectory, 1).linear_world.x(), 4.0 + 4.0, 1e-9);
  EXPECT_NEAR(noise.InnovationAt(trajectory, 2).linear_world.x(), -2.0, 1e-9);
}

// Of vertical velocities half goes on: what lacks has to be driven.
TEST(MotionNoise, VerticalVelocitiesDoNotGoOn) {
  Trajectory trajectory = WithOne(0, Standing(), 8);
  const double h = kIntervalS;
  double height = 0.0, velocity = 1.0;  // m, m/s
  for (int i = 1; i < trajectory.num_control_points(); ++i) {
    height += h * velocity;
    velocity *= 0.5;
    trajectory.control_point(i).position = {0.0, h * i, height};
  }
  MotionNoise noise = Ones();
  noise.vertical_velocity_correlation_s = h / std::log(2.0);
  for (int i = 0; i < 4; ++i) {
    EXPECT_LT(noise.InnovationAt(trajectory, i).linear_world.norm(), 1e-9);
  }
  // About a mean of 1 m/s, what is below it comes back.
  noise.vertical_velocity_m_s = 1.0;
  EXPECT_NEAR(noise.InnovationAt(trajectory, 0).linear_world.z(), -0.5 / h, 1e-9);
  noise.vertical_velocity_m_s = 0.0;
  noise.vertical_velocity_correlation_s = 1e12;
  EXPECT_NEAR(noise.InnovationAt(trajectory, 0).linear_world.z(), (0.25 - 0.5) / h, 1e-9);
}

// Over a second about each knot; what lies beyond the ends counts as standing.
TEST(MotionProfile, FollowsTheMeanOfTheHeight) {
  constexpr int kNumControlPoints = 82;  // 4 s
  Trajectory trajectory = WithOne(0, Standing(), kNumControlPoints);
  for (int i = 40; i < kNumControlPoints; ++i) {  // climbs from 2 s on
    trajectory.control_point(i).position = {0.0, 0.0, 0.4 * kIntervalS * (i - 40)};
  }
  const MotionProfile profile = MotionProfile::Uniform(Ones(), trajectory);
  EXPECT_EQ(profile.at[20].vertical_velocity_m_s, 0.0);
  EXPECT_NEAR(profile.at[39].vertical_velocity_m_s, 0.2, 1e-9);
  EXPECT_NEAR(profile.at[60].vertical_velocity_m_s, 0.4, 1e-9);
  EXPECT_NEAR(profile.at[79].vertical_velocity_m_s, 0.4 * 11.0 / 20.0, 1e-9);
}

// A jolt among calm knots is one of its own stretch: what is half a second away does not
// become loose, and the jolt itself is not far from what is expected there.
TEST(MotionProfile, AJoltLoosensItsOwnStretch) {
  ControlPoint jolt;
  jolt.position = {0.0, 0.0, 0.1};
  constexpr int kNumKnots = 500;
  const Trajectory trajectory = WithOne(100, jolt, kNumKnots + 2);
  const MotionProfile profile = MotionProfile::Of(trajectory, Ones());
  ASSERT_EQ(profile.at.size(), static_cast<size_t>(kNumKnots));
  const double acceleration = KnotAcceleration::At(trajectory, 99).linear_world.norm();
  EXPECT_LT(acceleration, 4.0 * profile.at[99].LinearStddev(kIntervalS).z());
  for (const size_t calm : {80, 120, 400}) {
    EXPECT_LT(profile.at[calm].density[kVertical], profile.usual.density[kVertical]);
    EXPECT_GT(profile.at[99].density[kVertical], 5.0 * profile.at[calm].density[kVertical]);
    EXPECT_EQ(profile.at[99].density[kYaw], profile.at[calm].density[kYaw]);
  }
}

// Where the scans determine nothing, the noise is the usual one.
TEST(MotionProfile, UndeterminedStretchesAreAsUsual) {
  MotionEvidence shown;
  shown.squares = {8.0, 4.0, 2.0, 1.0};
  shown.weight = kNumAxes;
  std::vector<MotionEvidence> evidence(100, shown);
  std::fill(evidence.begin() + 40, evidence.begin() + 60, MotionEvidence());
  const MotionProfile profile = MotionProfile::From(evidence, Ones(), kIntervalS);
  EXPECT_EQ(profile.at[50].density, profile.usual.density);
  EXPECT_NEAR(profile.usual.density[kHorizontal], 2.0, 0.02);
  EXPECT_NEAR(profile.usual.density[kTilt], 1.0, 0.02);
}

}  // namespace
}  // namespace plumbline
