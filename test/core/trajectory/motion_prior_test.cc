#include "core/trajectory/motion_prior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace plumbline {
namespace {

constexpr int64_t kKnotInterval = 50'000'000;  // ns

// A trajectory of accelerations along x of this noise.
Trajectory Shaken(const MotionNoise& noise, int num_control_points) {
  Trajectory trajectory(0, kKnotInterval, Rigid3d());
  trajectory.ExtendTo((num_control_points - 4) * kKnotInterval);
  const double h = trajectory.knot_interval_s();
  std::mt19937_64 random(3);
  std::normal_distribution<double> innovation(0.0, noise.LinearInnovationStddev(h).x());
  double acceleration = 0.0;
  for (int i = 2; i < trajectory.num_control_points(); ++i) {
    acceleration = noise.Persistence(h) * acceleration + innovation(random);
    trajectory.control_point(i).position[0] =
        2.0 * trajectory.control_point(i - 1).position[0] -
        trajectory.control_point(i - 2).position[0] + h * h * acceleration;
  }
  return trajectory;
}

TEST(MotionPrior, IsNarrowWhereTheMotionBridges) {
  TrajectoryOptions options;
  MotionPrior prior(options);
  prior.Bridge(5, 7);
  for (const int usual : {4, 7}) {
    EXPECT_EQ(prior.At(usual).density[kHorizontal], options.acceleration_density_m_s2);
  }
  for (const int bridged : {5, 6}) {
    EXPECT_EQ(prior.At(bridged).density[kHorizontal],
              options.bridging_acceleration_density_m_s2);
    for (const MotionKind kind : {kVertical, kTilt, kYaw}) {
      EXPECT_EQ(prior.At(bridged).density[kind], prior.At(4).density[kind]);
    }
  }
}

TEST(MotionPrior, IsNeverWiderThanUsual) {
  TrajectoryOptions options;
  options.acceleration_density_m_s2 = 0.1;
  MotionPrior prior(options);
  prior.Bridge(0, 1);
  EXPECT_EQ(prior.At(0).density[kHorizontal], 0.1);
}

// What is known exactly: after several times its memory it is what was shown, to the error of
// a standard deviation from the 200 accelerations of two axes that 5 s hold, and what the
// options say beforehand.
TEST(MotionPrior, LearnsHowTheRigMoves) {
  TrajectoryOptions options;
  MotionPrior prior(options);
  constexpr double kDensity = 0.2;
  MotionNoise noise = MotionNoise::Of(options);
  noise.density[kHorizontal] = kDensity;
  const Trajectory trajectory = Shaken(noise, 600);
  for (int i = 0; i + 3 < trajectory.num_control_points(); ++i) {
    prior.Learn(trajectory, i, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  }
  // One axis of two moves. The options count as 0.5 s of 5.5 s.
  const double expected2 =
      (5.0 * 0.5 * kDensity * kDensity +
       0.5 * options.acceleration_density_m_s2 * options.acceleration_density_m_s2) /
      5.5;
  EXPECT_NEAR(prior.usual().density[kHorizontal] / std::sqrt(expected2),
              1.0,
              3.0 / std::sqrt(2.0 * 100.0));
  EXPECT_LT(prior.usual().density[kTilt], 0.4 * MotionNoise::Of(options).density[kTilt]);
}

// Innovations of which the scans show nothing have the variance of the prior.
TEST(MotionPrior, KeepsWhatTheScansDoNotShow) {
  TrajectoryOptions options;
  MotionPrior prior(options);
  const MotionNoise before = prior.usual();
  const Trajectory still(0, kKnotInterval, Rigid3d());  // of four control points
  for (int i = 0; i < 100; ++i) {
    const double h = still.knot_interval_s();
    prior.Learn(still,
                0,
                before.LinearInnovationStddev(h).cwiseAbs2(),
                before.AngularInnovationStddev(h).cwiseAbs2());
  }
  for (size_t kind = 0; kind < kNumMotionKinds; ++kind) {
    EXPECT_NEAR(prior.usual().density[kind] / before.density[kind], 1.0, 1e-9);
  }
}

TEST(MotionPrior, LearnsNothingWhereItIsNotAskedTo) {
  TrajectoryOptions options;
  options.estimate_densities = false;
  MotionPrior prior(options);
  MotionNoise strong = prior.usual();
  strong.density.fill(5.0);
  prior.Learn(Shaken(strong, 8), 2, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  EXPECT_EQ(prior.usual().density, MotionNoise::Of(options).density);
}

}  // namespace
}  // namespace plumbline
