#include "factors/linear_algebra/elimination.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

struct System {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
};

System RandomSystem(Eigen::Index size, unsigned seed) {
  TestRandom random(seed);
  Eigen::MatrixXd jacobian(3 * size, size);
  for (double& value : jacobian.reshaped()) value = random.Uniform(-1.0, 1.0);
  jacobian.col(1) *= 1e4;  // other units
  Eigen::VectorXd residual(3 * size);
  for (double& value : residual) value = random.Uniform(-1.0, 1.0);
  return {jacobian.transpose() * jacobian, jacobian.transpose() * residual};
}

TEST(Elimination, FindsTheSameMinimumAndCovariance) {
  const System system = RandomSystem(7, 1);
  const Eigen::VectorXd minimum = -system.hessian.inverse() * system.gradient;
  const Eigen::MatrixXd covariance = system.hessian.inverse();
  const auto elimination = Elimination::Make(system.hessian, system.gradient, 4);
  ASSERT_TRUE(elimination);
  const Eigen::VectorXd x = -elimination->hessian().inverse() * elimination->gradient();
  EXPECT_LT((x - minimum.tail(3)).norm(), 1e-10);
  EXPECT_LT((elimination->BackSubstitute(x) - minimum.head(4)).norm(), 1e-10);
  const Eigen::MatrixXd root = elimination->ConditionalRoot();
  const Eigen::MatrixXd gain = elimination->Gain();
  const Eigen::MatrixXd found =
      root.transpose() * root + gain * covariance.bottomRightCorner(3, 3) * gain.transpose();
  EXPECT_LT((found - covariance.topLeftCorner(4, 4)).norm(), 1e-10 * covariance.norm());
}

TEST(Elimination, HeldVariablesStay) {
  System system = RandomSystem(6, 2);
  system.hessian.row(2).setZero();
  system.hessian.col(2).setZero();
  system.gradient[2] = 0.0;
  const auto elimination = Elimination::Make(system.hessian, system.gradient, 4);
  ASSERT_TRUE(elimination);
  EXPECT_EQ(elimination->BackSubstitute(Eigen::Vector2d(1.0, -1.0))[2], 0.0);
  EXPECT_EQ(elimination->Gain().row(2).norm(), 0.0);
  EXPECT_EQ(elimination->ConditionalRoot().col(2).norm(), 0.0);
}

TEST(Elimination, NothingWhereTheCostDoesNotDetermineTheVariables) {
  System system = RandomSystem(5, 3);
  system.hessian.row(1) = system.hessian.row(0);
  system.hessian.col(1) = system.hessian.col(0);
  system.hessian(1, 1) = 0.5 * system.hessian(0, 0);
  EXPECT_FALSE(Elimination::Make(system.hessian, system.gradient, 3));
}

TEST(Elimination, NothingToEliminate) {
  const System system = RandomSystem(4, 4);
  const auto elimination = Elimination::Make(system.hessian, system.gradient, 0);
  ASSERT_TRUE(elimination);
  EXPECT_EQ((elimination->hessian() - system.hessian).norm(), 0.0);
  EXPECT_EQ(elimination->BackSubstitute(Eigen::Vector4d::Ones()).size(), 0);
}

}  // namespace
}  // namespace plumbline
