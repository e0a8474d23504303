#include "factors/spline/rotation_motion.h"

#include <gtest/gtest.h>

#include <array>

#include "factors/spline/so3.h"
#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

constexpr double kInterval = 0.05;  // s
constexpr double kStep = 1e-5;      // of differences

using Vectors = std::array<Eigen::Vector3d, 3>;

RotationMotion MotionOf(const Vectors& vectors, double u) {
  std::array<RotationStep, 3> steps;
  for (size_t j = 0; j < 3; ++j) steps[j].vector = vectors[j];
  return EvaluateRotationMotion(steps.data(), u, kInterval);
}

class RotationMotionTest : public testing::Test {
 protected:
  TestRandom random_{3};
  Vectors vectors_ = {random_.Vector(0.5), random_.Vector(0.5), random_.Vector(0.5)};
};

// Rate and angular acceleration are differences of rotations and rates by time.
TEST_F(RotationMotionTest, IsTheMotionOfTheRotation) {
  const double u = 1.1;  // a delay may lead out of the interval
  const RotationMotion before = MotionOf(vectors_, u - kStep);
  const RotationMotion motion = MotionOf(vectors_, u);
  const RotationMotion after = MotionOf(vectors_, u + kStep);
  const Eigen::Quaterniond turn(before.body_from_first * after.body_from_first.transpose());
  EXPECT_LT((Log(turn) / (2.0 * kStep * kInterval) - motion.rate).norm(), 1e-6);
  EXPECT_LT(
      ((after.rate - before.rate) / (2.0 * kStep * kInterval) - motion.acceleration).norm(),
      1e-4);
  EXPECT_LT(((after.rate - before.rate) / (2.0 * kStep) - motion.rate_by_u).norm(), 1e-6);
  EXPECT_LT(
      ((after.acceleration - before.acceleration) / (2.0 * kStep) - motion.acceleration_by_u)
          .norm(),
      1e-4);
}

TEST_F(RotationMotionTest, DerivativesByTheSteps) {
  const double u = 0.3;
  const RotationMotion motion = MotionOf(vectors_, u);
  for (int i = 0; i < 9; ++i) {
    Vectors less = vectors_;
    Vectors more = vectors_;
    less[static_cast<size_t>(i / 3)][i % 3] -= kStep;
    more[static_cast<size_t>(i / 3)][i % 3] += kStep;
    const RotationMotion before = MotionOf(less, u);
    const RotationMotion after = MotionOf(more, u);
    const Eigen::Quaterniond turn(before.body_from_first * after.body_from_first.transpose());
    EXPECT_LT((Log(turn) / (2.0 * kStep) - motion.turn_by_steps.col(i)).norm(), 1e-8) << i;
    EXPECT_LT(
        ((after.rate - before.rate) / (2.0 * kStep) - motion.rate_by_steps.col(i)).norm(),
        1e-6)
        << i;
    EXPECT_LT(((after.acceleration - before.acceleration) / (2.0 * kStep) -
               motion.acceleration_by_steps.col(i))
                  .norm(),
              1e-4)
        << i;
  }
}

}  // namespace
}  // namespace plumbline
