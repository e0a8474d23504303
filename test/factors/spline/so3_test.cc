#include "factors/spline/so3.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

constexpr double kPi = 3.14159265358979323846;

TEST(So3, ExpOfQuarterTurn) {
  const Eigen::Quaterniond q = Exp(Eigen::Vector3d(0.0, 0.0, kPi / 2));
  EXPECT_LT((q * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

TEST(So3, LogInvertsExpAtEveryScale) {
  TestRandom random(1);
  for (const double angle : {0.0,
                             1e-12,
                             1e-8,
                             0.00199,
                             0.00201,
                             0.0099,
                             0.0101,
                             1.0,
                             3.0,
                             kPi - 1e-3,
                             kPi - 1e-9}) {
    const Eigen::Vector3d d = angle * random.Vector(1.0).normalized();
    const Eigen::Quaterniond q = Exp(d);
    EXPECT_NEAR(q.norm(), 1.0, 1e-15) << angle;
    EXPECT_LT((Log(q) - d).norm(), 1e-14) << angle;
    EXPECT_LT((Log(Eigen::Quaterniond(-q.coeffs())) - d).norm(), 1e-14) << angle;
  }
}

TEST(So3, LogOfHalfTurnHasLengthPi) {
  EXPECT_NEAR(Log(Eigen::Quaterniond(0.0, 0.6, 0.0, 0.8)).norm(), kPi, 1e-15);
}

TEST(So3, LogIgnoresTheQuaternionsLength) {
  const Eigen::Vector3d d(0.3, -0.2, 0.9);
  EXPECT_LT((Log(Eigen::Quaterniond(1.01 * Exp(d).coeffs())) - d).norm(), 1e-15);
}

// d Log(Exp(d)) / d d = I through Jets, also at zero and on both sides of the series' limits.
TEST(So3, DerivativeOfLogExpIsIdentity) {
  using Jet = ceres::Jet<double, 3>;
  TestRandom random(2);
  for (const double angle : {0.0, 1e-9, 0.00199, 0.00201, 0.0099, 0.0101, 1.0, 3.1}) {
    const Eigen::Vector3d d = angle * random.Vector(1.0).normalized();
    const Eigen::Matrix<Jet, 3, 1> jets(Jet(d[0], 0), Jet(d[1], 1), Jet(d[2], 2));
    const Eigen::Matrix<Jet, 3, 1> same = Log(Exp(jets));
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT((same[i].v - Eigen::Vector3d::Unit(i)).norm(), 1e-12) << angle;
    }
  }
}

TEST(So3, LeftJacobianIsDerivativeOfExp) {
  TestRandom random(3);
  const double step = 1e-6;
  for (const double angle : {0.0, 1e-5, 0.0999, 0.1001, 1.0, 3.0}) {
    const Eigen::Vector3d d = angle * random.Vector(1.0).normalized();
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d e = step * Eigen::Vector3d::Unit(i);
      const Eigen::Vector3d numeric =
          (Log(Exp(d + e) * Exp(d).conjugate()) - Log(Exp(d - e) * Exp(d).conjugate())) /
          (2 * step);
      EXPECT_LT((LeftJacobian(d).col(i) - numeric).norm(), 1e-9) << angle;
    }
    const Eigen::Matrix3d product = LeftJacobian(d) * LeftJacobianInverse(d);
    EXPECT_LT((product - Eigen::Matrix3d::Identity()).norm(), 1e-14) << angle;
  }
}

TEST(So3, LeftJacobiansAreContinuousWhereTheSeriesEnds) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
  const Eigen::Vector3d below = 0.1 * (1.0 - 1e-15) * axis;
  const Eigen::Vector3d above = 0.1 * (1.0 + 1e-15) * axis;
  EXPECT_LT((LeftJacobian(below) - LeftJacobian(above)).norm(), 1e-14);
  EXPECT_LT((LeftJacobianInverse(below) - LeftJacobianInverse(above)).norm(), 1e-14);
}

}  // namespace
}  // namespace plumbline
