#include "factors/linear_algebra/square_root_marginalisation.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <limits>
#include <stdexcept>

#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

Eigen::MatrixXd RandomMatrix(Eigen::Index rows, Eigen::Index cols, TestRandom* random) {
  Eigen::MatrixXd matrix(rows, cols);
  for (double& value : matrix.reshaped()) value = random->Uniform(-1.0, 1.0);
  return matrix;
}

TEST(Schur, TwoVariablesByHand) {
  // Minimum over y of (y + x - 1)^2 + (y - x)^2 is (2 x - 1)^2 / 2.
  Eigen::Matrix2d jacobian;
  jacobian << 1.0, 1.0, 1.0, -1.0;
  const Eigen::Vector2d residual(-1.0, 0.0);
  const MarginalisedSystem system =
      Marginalise(jacobian.transpose() * jacobian, jacobian.transpose() * residual, 1);
  ASSERT_EQ(system.rank, 1);
  EXPECT_EQ(system.marginalised_rank, 1);
  EXPECT_NEAR(std::abs(system.root(0, 0)), std::sqrt(2.0), 1e-14);
  EXPECT_NEAR(system.root(0, 0) * system.offset[0], -1.0, 1e-14);
}

// With a full matrix: a root that is transposed by mistake does not pass.
TEST(Schur, KeepsTheMinimumAndItsCurvature) {
  TestRandom random(5);
  const Eigen::MatrixXd jacobian = RandomMatrix(20, 9, &random);
  const Eigen::VectorXd residual = RandomMatrix(20, 1, &random);
  const Eigen::MatrixXd hessian = jacobian.transpose() * jacobian;
  const MarginalisedSystem system = Marginalise(hessian, jacobian.transpose() * residual, 4);
  EXPECT_EQ(system.rank, 5);
  EXPECT_EQ(system.marginalised_rank, 4);

  // The covariance of the kept variables is a block of the full inverse.
  const Eigen::MatrixXd covariance = hessian.inverse().bottomRightCorner(5, 5);
  const Eigen::MatrixXd information = system.root.transpose() * system.root;
  EXPECT_LT((information * covariance - Eigen::MatrixXd::Identity(5, 5)).norm(), 1e-10);

  const auto cost_of_kept = [&](const Eigen::VectorXd& x) {
    const Eigen::VectorXd rest = residual + jacobian.rightCols(5) * x;
    const Eigen::MatrixXd marginalised = jacobian.leftCols(4);
    const Eigen::VectorXd y = marginalised.colPivHouseholderQr().solve(-rest);
    return (rest + marginalised * y).squaredNorm();
  };
  const double constant = cost_of_kept(Eigen::VectorXd::Zero(5)) - system.offset.squaredNorm();
  for (int trial = 0; trial < 5; ++trial) {
    const Eigen::VectorXd x = RandomMatrix(5, 1, &random);
    EXPECT_NEAR(
        (system.offset + system.root * x).squaredNorm() + constant, cost_of_kept(x), 1e-11);
  }
}

TEST(Schur, RowsAreZeroInWhatWasEliminatedBefore) {
  TestRandom random(7);
  const Eigen::MatrixXd jacobian = RandomMatrix(20, 9, &random);
  const Eigen::VectorXd residual = RandomMatrix(20, 1, &random);
  const MarginalisedSystem system =
      Marginalise(jacobian.transpose() * jacobian, jacobian.transpose() * residual, 3);
  ASSERT_EQ(system.rank, 6);
  const Eigen::MatrixXd ordered = system.root(Eigen::all, system.order);
  EXPECT_EQ(Eigen::MatrixXd(ordered.triangularView<Eigen::StrictlyLower>()).norm(), 0.0);
  EXPECT_GT(ordered.diagonal().minCoeff(), 0.0);
}

TEST(Schur, ReportsFreeDirections) {
  TestRandom random(6);
  // Kept variables 0 and 1 are only ever seen through their sum, in very different units.
  Eigen::MatrixXd jacobian = RandomMatrix(20, 6, &random);
  jacobian.col(3) = 1e4 * jacobian.col(2);
  // Marginalised variable 1 is not seen at all.
  jacobian.col(1).setZero();
  const Eigen::VectorXd residual = RandomMatrix(20, 1, &random);
  const Eigen::MatrixXd hessian = jacobian.transpose() * jacobian;
  const Eigen::VectorXd gradient = jacobian.transpose() * residual;
  const MarginalisedSystem system = Marginalise(hessian, gradient, 2);
  EXPECT_EQ(system.marginalised_rank, 1);
  ASSERT_EQ(system.rank, 3);
  ASSERT_EQ(system.root.rows(), 3);
  // The free direction stays free.
  Eigen::VectorXd free = Eigen::VectorXd::Zero(4);
  free << 1e4, -1.0, 0.0, 0.0;
  EXPECT_LT((system.root * free).norm(), 1e-7);

  const Eigen::VectorXd column = jacobian.col(0);
  const Eigen::MatrixXd projector =
      Eigen::MatrixXd::Identity(20, 20) - column * column.transpose() / column.squaredNorm();
  const Eigen::MatrixXd kept = jacobian.rightCols(4);
  const Eigen::MatrixXd expected = kept.transpose() * projector * kept;
  EXPECT_LT((system.root.transpose() * system.root - expected).norm(),
            1e-10 * expected.norm());
  const Eigen::VectorXd expected_gradient = kept.transpose() * projector * residual;
  EXPECT_LT((system.root.transpose() * system.offset - expected_gradient).norm(),
            1e-10 * expected_gradient.norm());
}

TEST(Schur, NothingToMarginalise) {
  TestRandom random(8);
  const Eigen::MatrixXd jacobian = RandomMatrix(10, 3, &random);
  const Eigen::VectorXd residual = RandomMatrix(10, 1, &random);
  const Eigen::MatrixXd hessian = jacobian.transpose() * jacobian;
  const MarginalisedSystem system = Marginalise(hessian, jacobian.transpose() * residual, 0);
  EXPECT_LT((system.root.transpose() * system.root - hessian).norm(), 1e-13);
}

TEST(Schur, RefusesAnIndefiniteMatrix) {
  Eigen::Matrix2d hessian;
  hessian << 1.0, 2.0, 2.0, 1.0;
  EXPECT_THROW(Marginalise(hessian, Eigen::Vector2d::Zero(), 0), std::runtime_error);
  hessian << 1.0, 0.0, 0.0, std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Marginalise(hessian, Eigen::Vector2d::Zero(), 0), std::runtime_error);
}

}  // namespace
}  // namespace plumbline
