#include "factors/manifold/manifolds.h"

#include <ceres/manifold_test_utils.h>
#include <gtest/gtest.h>

#include <cmath>

#include "factors/spline/so3.h"
#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

using namespace ceres;  // EXPECT_THAT_MANIFOLD_INVARIANTS_HOLD names its matchers from inside

constexpr double kTolerance = 1e-9;

TEST(Manifolds, RotationKeepsTheInvariants) {
  const auto owner = CreateRotationManifold();
  const Manifold& manifold = *owner;
  TestRandom random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Quaterniond q = random.Rotation(random.Uniform(0.0, 3.0));
    const Eigen::VectorXd x = q.coeffs();
    // Of y and -y the one that Plus(x, .) reaches.
    const Eigen::VectorXd y = (random.Rotation(random.Uniform(0.0, 3.0)) * q).coeffs();
    const Eigen::VectorXd delta = random.Vector(1.0);
    EXPECT_THAT_MANIFOLD_INVARIANTS_HOLD(manifold, x, delta, y, kTolerance);
  }
}

TEST(Manifolds, RotationPerturbsOnTheLeft) {
  const auto manifold = CreateRotationManifold();
  const Eigen::Quaterniond q = Exp(Eigen::Vector3d(0.5, 1.0, -0.3));
  const Eigen::Vector3d delta(0.1, -0.2, 0.3);
  Eigen::Quaterniond result;
  manifold->Plus(q.coeffs().data(), delta.data(), result.coeffs().data());
  EXPECT_LT((result.coeffs() - (Exp(delta) * q).coeffs()).norm(), 1e-15);
}

TEST(Manifolds, RotationMinusJacobianInvertsPlusJacobian) {
  TestRandom random(2);
  const Eigen::Quaterniond q = random.Rotation(2.5);
  const Eigen::Matrix3d product =
      RotationMinusJacobian(q.coeffs().data()) * RotationPlusJacobian(q.coeffs().data());
  EXPECT_LT((product - Eigen::Matrix3d::Identity()).norm(), 1e-15);
  EXPECT_LT((RotationMinusJacobian(q.coeffs().data()) * q.coeffs()).norm(), 1e-15);
}

TEST(Manifolds, YawKeepsTheInvariants) {
  const auto owner = CreateYawManifold();
  const Manifold& manifold = *owner;
  TestRandom random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Quaterniond q = random.Rotation(random.Uniform(0.0, 3.0));
    const Eigen::VectorXd x = q.coeffs();
    // Only points that differ by a yaw are on the same manifold.
    const Eigen::VectorXd y =
        (Exp(random.Uniform(-3.0, 3.0) * Eigen::Vector3d::UnitZ()) * q).coeffs();
    const Eigen::VectorXd delta = Eigen::VectorXd::Constant(1, random.Uniform(-1.0, 1.0));
    EXPECT_THAT_MANIFOLD_INVARIANTS_HOLD(manifold, x, delta, y, kTolerance);
  }
}

TEST(Manifolds, YawTurnsAboutTheWorldsVertical) {
  const auto manifold = CreateYawManifold();
  const Eigen::Quaterniond q = Exp(Eigen::Vector3d(0.4, 0.0, 0.0));
  const double delta = 0.7;
  Eigen::Quaterniond result;
  manifold->Plus(q.coeffs().data(), &delta, result.coeffs().data());
  // The body's z axis keeps its inclination.
  EXPECT_NEAR((result * Eigen::Vector3d::UnitZ()).z(), std::cos(0.4), 1e-15);
  EXPECT_NEAR(YawDifference(result.coeffs().data(), q.coeffs().data()), 0.7, 1e-15);
}

TEST(Manifolds, VerticalPlaneKeepsTheInvariants) {
  const auto owner = CreateVerticalPlaneManifold(Eigen::Vector2d(12.0, -7.0));
  const Manifold& manifold = *owner;
  TestRandom random(7);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::VectorXd x =
        Eigen::Vector2d(random.Uniform(-3.0, 3.0), random.Uniform(-20.0, 20.0));
    const Eigen::VectorXd y =
        Eigen::Vector2d(random.Uniform(-3.0, 3.0), random.Uniform(-20.0, 20.0));
    const Eigen::VectorXd delta =
        Eigen::Vector2d(random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0));
    EXPECT_THAT_MANIFOLD_INVARIANTS_HOLD(manifold, x, delta, y, kTolerance);
  }
}

TEST(Manifolds, VerticalPlaneTurnsAboutItsCentre) {
  const Eigen::Vector2d centre(12.0, -7.0);
  const auto manifold = CreateVerticalPlaneManifold(centre);
  const double a = 0.4;
  const double turn = 0.3;
  const Eigen::Vector2d normal(std::cos(a), std::sin(a));
  const Eigen::Vector2d derivative(-std::sin(a), std::cos(a));
  const double x[] = {a, normal.dot(centre)};
  // The tangent of a turn about the centre.
  const double delta[] = {turn, turn * derivative.dot(centre)};
  double turned[2];
  manifold->Plus(x, delta, turned);
  const Eigen::Vector2d turned_normal(std::cos(turned[0]), std::sin(turned[0]));
  EXPECT_NEAR(turned_normal.dot(centre) - turned[1], 0.0, 1e-14);
}

}  // namespace
}  // namespace plumbline
