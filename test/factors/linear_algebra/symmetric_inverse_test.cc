#include "factors/linear_algebra/symmetric_inverse.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

// Metres beside radians: the last column's unit is 1e4 times smaller.
Eigen::MatrixXd PositiveMatrix(Eigen::Index size, unsigned seed) {
  TestRandom random(seed);
  Eigen::MatrixXd jacobian(2 * size, size);
  for (double& value : jacobian.reshaped()) value = random.Uniform(-1.0, 1.0);
  jacobian.col(size - 1) *= 1e4;
  return jacobian.transpose() * jacobian;
}

TEST(SymmetricInverse, TimesTheMatrixIsTheIdentity) {
  for (const Eigen::Index size : {1, 2, 7, 30}) {
    const Eigen::MatrixXd matrix = PositiveMatrix(size, static_cast<unsigned>(size));
    const auto inverse = SymmetricInverse(matrix);
    ASSERT_TRUE(inverse);
    EXPECT_LT((*inverse * matrix - Eigen::MatrixXd::Identity(size, size)).norm(), 1e-8);
    EXPECT_EQ(*inverse, inverse->transpose());
  }
}

TEST(SymmetricInverse, ReadsOnlyTheLowerTriangle) {
  const Eigen::MatrixXd matrix = PositiveMatrix(6, 1);
  Eigen::MatrixXd lower = matrix;
  lower.triangularView<Eigen::StrictlyUpper>().setConstant(1e3);
  EXPECT_EQ(*SymmetricInverse(lower), *SymmetricInverse(matrix));
}

TEST(SymmetricInverse, NothingForMatricesThatAreNotPositiveDefinite) {
  EXPECT_FALSE(SymmetricInverse(Eigen::MatrixXd::Zero(3, 3)));
  EXPECT_FALSE(SymmetricInverse(-Eigen::MatrixXd::Identity(2, 2)));
  Eigen::Matrix2d indefinite;
  indefinite << 1.0, 2.0, 2.0, 1.0;
  EXPECT_FALSE(SymmetricInverse(indefinite));
}

TEST(SymmetricInverse, EmptyMatrixHasAnEmptyInverse) {
  EXPECT_EQ(SymmetricInverse(Eigen::MatrixXd())->size(), 0);
}

}  // namespace
}  // namespace plumbline
