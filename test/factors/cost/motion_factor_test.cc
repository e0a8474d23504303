#include "factors/cost/motion_factor.h"

#include <gtest/gtest.h>

#include "factors/spline/so3.h"
#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

constexpr double kInterval = 0.125;

TEST(MotionFactor, PositionAccelerationByHand) {
  // Control points of x = a t^2 / 2 with a = 4 m/s^2, and -2 m/s^2 in z: the second difference
  // over h^2 is a.
  TestBlocks blocks;
  for (const double t : {-kInterval, 0.0, kInterval}) {
    blocks.AddEuclidean(Eigen::Vector3d(2.0 * t * t, 3.0 * t + 1.0, -t * t));
  }
  const auto factor = CreatePositionAccelerationFactor({2.0, 4.0, 5.0}, {}, kInterval);
  EXPECT_LT((blocks.Residuals(*factor) - Eigen::Vector3d(2.0, 0.0, -0.4)).norm(), 1e-12);
  blocks.ExpectGradientsCorrect(*factor);
}

TEST(MotionFactor, RotationAccelerationByHand) {
  TestBlocks blocks;
  const double angle = 2.0 * kInterval * kInterval;  // 4 rad/s^2 about z
  for (const double yaw : {angle, 0.0, angle}) {
    blocks.AddRotation(Exp(Eigen::Vector3d(0.0, 0.0, yaw)));
  }
  const auto factor = CreateRotationAccelerationFactor({4.0, 8.0, 2.0}, kInterval);
  EXPECT_LT((blocks.Residuals(*factor) - Eigen::Vector3d(0.0, 0.0, 2.0)).norm(), 1e-12);
  blocks.ExpectGradientsCorrect(*factor);
}

TEST(MotionFactor, RotationAccelerationFarRotations) {
  TestRandom random(7);
  for (const double step : {0.05, 1.0, 3.0}) {
    TestBlocks blocks;
    Eigen::Quaterniond q = random.Rotation(2.0);
    for (int j = 0; j < 3; ++j) {
      blocks.AddRotation(q);
      q = random.Rotation(step) * q;
    }
    blocks.ExpectGradientsCorrect(
        *CreateRotationAccelerationFactor({10.0, 20.0, 5.0}, kInterval));
  }
}

TEST(MotionFactor, ConstantVelocityCostsNothing) {
  const Eigen::Vector3d rate(0.3, -0.2, 0.5), speed(1.0, -1.0, 0.2);
  TestBlocks rotations, positions;
  for (int j = 0; j < 3; ++j) {
    rotations.AddRotation(Exp(j * rate) * Exp(Eigen::Vector3d(1.0, 0.0, 0.0)));
    positions.AddEuclidean(j * speed);
  }
  const auto rotation_factor = CreateRotationAccelerationFactor({1.0, 2.0, 3.0}, kInterval);
  const auto position_factor =
      CreatePositionAccelerationFactor(Eigen::Vector3d::Ones(), {}, kInterval);
  EXPECT_LT(rotations.Residuals(*rotation_factor).norm(), 1e-12);
  EXPECT_LT(positions.Residuals(*position_factor).norm(), 1e-12);
  rotations.ExpectGradientsCorrect(*rotation_factor);
}

// What turns about the vertical does not tilt, however the body leans.
TEST(MotionFactor, ATurnOfABodyThatLeansIsOneAboutTheVertical) {
  TestBlocks blocks;
  const double angle = 2.0 * kInterval * kInterval;  // 4 rad/s^2 about z
  for (const double yaw : {angle, 0.0, angle}) {
    blocks.AddRotation(Exp(Eigen::Vector3d(0.0, 0.0, yaw)) *
                       Exp(Eigen::Vector3d(0.3, -0.2, 0.0)));
  }
  const auto factor = CreateRotationAccelerationFactor({1.0, 1.0, 2.0}, kInterval);
  EXPECT_LT((blocks.Residuals(*factor) - Eigen::Vector3d(0.0, 0.0, 2.0)).norm(), 1e-12);
}

TEST(MotionFactor, InnovationsByHand) {
  // Accelerations of 4, then 1 m/s^2 and 4, then 1 rad/s^2: three of them go on.
  constexpr double kPersistence = 0.75;
  TestBlocks positions, rotations;
  const double a = kInterval * kInterval;
  for (const double x : {0.0, 0.0, 4.0 * a, 9.0 * a}) {
    positions.AddEuclidean(Eigen::Vector3d(0.0, x, 0.0));
    rotations.AddRotation(Exp(Eigen::Vector3d(x, 0.0, 0.0)));
  }
  const auto position_factor = CreatePositionInnovationFactor(
      {1.0, 0.5, 1.0},
      {Eigen::Vector3d::Ones(), Eigen::Vector3d::Constant(kPersistence)},
      kInterval);
  EXPECT_LT((positions.Residuals(*position_factor) - Eigen::Vector3d(0.0, -4.0, 0.0)).norm(),
            1e-12);
  positions.ExpectGradientsCorrect(*position_factor);
  const auto rotation_factor =
      CreateRotationInnovationFactor({0.5, 1.0, 1.0}, kPersistence, kInterval);
  EXPECT_LT((rotations.Residuals(*rotation_factor) - Eigen::Vector3d(-4.0, 0.0, 0.0)).norm(),
            1e-12);
  rotations.ExpectGradientsCorrect(*rotation_factor);
}

// Vertically half of a velocity goes on: a velocity of 4, then 2 and 1 m/s needs nothing, one
// that stays what it lacks.
TEST(MotionFactor, VelocitiesThatDoNotGoOnByHand) {
  const MotionPersistence persistence = {{1.0, 1.0, 0.5}, {0.75, 0.75, 0.0}};
  TestBlocks fading, staying;
  for (const double z : {0.0, 4.0, 6.0, 7.0}) {
    fading.AddEuclidean(Eigen::Vector3d(0.0, 0.0, z * kInterval));
  }
  for (const double z : {0.0, 4.0, 8.0, 12.0}) {
    staying.AddEuclidean(Eigen::Vector3d(0.0, z * kInterval, z * kInterval));
  }
  const auto factor =
      CreatePositionInnovationFactor(Eigen::Vector3d::Ones(), persistence, kInterval);
  EXPECT_LT(fading.Residuals(*factor).norm(), 1e-12);
  EXPECT_LT((staying.Residuals(*factor) - Eigen::Vector3d(0.0, 0.0, 2.0 / kInterval)).norm(),
            1e-12);
  staying.ExpectGradientsCorrect(*factor);
}

TEST(MotionFactor, RotationInnovationFarRotations) {
  TestRandom random(8);
  for (const double step : {0.05, 1.0, 3.0}) {
    TestBlocks blocks;
    Eigen::Quaterniond q = random.Rotation(2.0);
    for (int j = 0; j < 4; ++j) {
      blocks.AddRotation(q);
      q = random.Rotation(step) * q;
    }
    blocks.ExpectGradientsCorrect(
        *CreateRotationInnovationFactor({10.0, 20.0, 5.0}, 0.6, kInterval));
  }
}

TEST(MotionFactor, VelocitiesByHand) {
  TestBlocks positions, rotations, deactivated;
  positions.AddEuclidean(Eigen::Vector3d(1.0, 1.0, 1.0));
  positions.AddEuclidean(Eigen::Vector3d(1.5, 1.0, 0.0));
  const auto position_factor = CreatePositionVelocityFactor(2.0, kInterval);
  EXPECT_LT((positions.Residuals(*position_factor) - Eigen::Vector3d(2.0, 0.0, -4.0)).norm(),
            1e-12);
  positions.ExpectGradientsCorrect(*position_factor);

  // The rotation vector is seen in the world.
  const Eigen::Quaterniond first = Exp(Eigen::Vector3d(0.0, 0.0, 1.0));
  rotations.AddRotation(first);
  rotations.AddRotation(Exp(Eigen::Vector3d(0.5, 0.0, 0.0)) * first);
  const auto rotation_factor = CreateRotationVelocityFactor(2.0, kInterval);
  EXPECT_LT((rotations.Residuals(*rotation_factor) - Eigen::Vector3d(2.0, 0.0, 0.0)).norm(),
            1e-12);
  rotations.ExpectGradientsCorrect(*rotation_factor);

  deactivated.AddRotation(first);
  deactivated.AddRotation(first);
  EXPECT_LT(deactivated.Residuals(*rotation_factor).norm(), 1e-14);
  deactivated.ExpectGradientsCorrect(*rotation_factor);
}

}  // namespace
}  // namespace plumbline
