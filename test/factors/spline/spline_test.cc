#include "factors/spline/spline.h"

#include <gtest/gtest.h>

#include <vector>

#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

// n control points and the pointers to any four of them.
struct TestSpline {
  std::vector<Eigen::Quaterniond> q;
  std::vector<Eigen::Vector3d> p;

  TestSpline(int n, double step, unsigned seed) {
    TestRandom random(seed);
    Eigen::Quaterniond rotation = random.Rotation(2.0);
    for (int i = 0; i < n; ++i) {
      q.push_back(rotation);
      p.push_back(random.Vector(3.0));
      rotation = random.Rotation(step) * rotation;
    }
  }

  std::array<const double*, 4> Rotations(int first) const {
    const size_t i = static_cast<size_t>(first);
    return {q[i].coeffs().data(),
            q[i + 1].coeffs().data(),
            q[i + 2].coeffs().data(),
            q[i + 3].coeffs().data()};
  }
  std::array<const double*, 4> Positions(int first) const {
    const size_t i = static_cast<size_t>(first);
    return {p[i].data(), p[i + 1].data(), p[i + 2].data(), p[i + 3].data()};
  }
  SplinePose Pose(int first, double u, SplinePoseJacobian* jacobian = nullptr) const {
    return EvaluatePose(Rotations(first).data(), Positions(first).data(), u, jacobian);
  }
  void Velocity(int first, double u, Eigen::Vector3d* angular, Eigen::Vector3d* linear) const {
    EvaluateVelocity(
        Rotations(first).data(), Positions(first).data(), u, 1.0, angular, linear);
  }
};

Eigen::Vector3d LeftDifference(const Eigen::Quaterniond& to, const Eigen::Quaterniond& from) {
  return Log(to * from.conjugate());
}

TEST(Spline, BasisAtTheKnotAndItsTailSums) {
  const std::array<double, 4> knot = SplineBasis(0.0);
  EXPECT_DOUBLE_EQ(knot[0], 1.0 / 6.0);
  EXPECT_DOUBLE_EQ(knot[1], 4.0 / 6.0);
  EXPECT_DOUBLE_EQ(knot[2], 1.0 / 6.0);
  EXPECT_DOUBLE_EQ(knot[3], 0.0);
  for (const double u : {0.0, 0.3, 0.7, 0.999}) {
    const std::array<double, 4> basis = SplineBasis(u);
    const std::array<double, 4> cumulative = CumulativeSplineBasis(u);
    double sum = 0.0;
    for (int j = 3; j >= 0; --j) {
      sum += basis[j];
      EXPECT_NEAR(cumulative[j], sum, 1e-15);
    }
    const double step = 1e-6;
    for (int j = 0; j < 4; ++j) {
      const double numeric =
          (CumulativeSplineBasis(u + step)[j] - CumulativeSplineBasis(u - step)[j]) /
          (2 * step);
      EXPECT_NEAR(CumulativeSplineBasisDerivative(u)[j], numeric, 1e-9);
    }
  }
}

TEST(Spline, TemplatedAndDoubleEvaluationAgree) {
  for (const double step : {1e-9, 0.1, 1.5}) {
    const TestSpline spline(4, step, 5);
    SplinePoseJacobian jacobian;
    for (const double u : {0.0, 0.4, 0.95}) {
      Eigen::Quaterniond rotation;
      Eigen::Vector3d position;
      EvaluateRotation(spline.Rotations(0).data(), u, rotation.coeffs().data());
      EvaluatePosition(spline.Positions(0).data(), u, position.data());
      for (const SplinePose& pose : {spline.Pose(0, u), spline.Pose(0, u, &jacobian)}) {
        EXPECT_LT(LeftDifference(pose.world_from_body, rotation).norm(), 1e-14);
        EXPECT_LT((pose.position - position).norm(), 1e-14);
      }
    }
  }
}

TEST(Spline, PoseJacobianMatchesFiniteDifferences) {
  const double h = 1e-6;
  // The last step is close to pi, as far as neighbours may be apart.
  for (const double step : {0.0, 1e-4, 0.1, 0.5, 2.0, 3.1}) {
    TestSpline spline(4, step, 11);
    for (const double u : {0.0, 0.5, 0.9}) {
      SplinePoseJacobian jacobian;
      const SplinePose pose = spline.Pose(0, u, &jacobian);
      for (size_t j = 0; j < 4; ++j) {
        const Eigen::Quaterniond q = spline.q[j];
        for (int axis = 0; axis < 3; ++axis) {
          const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(axis);
          spline.q[j] = Exp(e) * q;
          const Eigen::Quaterniond plus = spline.Pose(0, u).world_from_body;
          spline.q[j] = Exp(-e) * q;
          const Eigen::Quaterniond minus = spline.Pose(0, u).world_from_body;
          spline.q[j] = q;
          const Eigen::Vector3d numeric = (LeftDifference(plus, pose.world_from_body) -
                                           LeftDifference(minus, pose.world_from_body)) /
                                          (2 * h);
          EXPECT_LT((jacobian.rotation_wrt_control[j].col(axis) - numeric).norm(), 2e-8)
              << "step " << step << " u " << u << " control point " << j;
        }
        const Eigen::Vector3d p = spline.p[j];
        spline.p[j] += Eigen::Vector3d(1.0, 2.0, 3.0);
        const Eigen::Vector3d moved = spline.Pose(0, u).position - pose.position;
        spline.p[j] = p;
        EXPECT_LT((moved - jacobian.position_weights[j] * Eigen::Vector3d(1, 2, 3)).norm(),
                  1e-14);
      }
    }
  }
}

// Turning all control points by the same world rotation turns the result by it.
TEST(Spline, RotationJacobiansSumToIdentity) {
  const TestSpline spline(4, 1.0, 17);
  SplinePoseJacobian jacobian;
  spline.Pose(0, 0.35, &jacobian);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Matrix3d& block : jacobian.rotation_wrt_control) sum += block;
  EXPECT_LT((sum - Eigen::Matrix3d::Identity()).norm(), 1e-14);
}

TEST(Spline, TwiceContinuouslyDifferentiableAcrossAKnot) {
  const TestSpline spline(5, 0.8, 23);
  const SplinePose before = spline.Pose(0, 1.0);
  const SplinePose after = spline.Pose(1, 0.0);
  EXPECT_LT(LeftDifference(before.world_from_body, after.world_from_body).norm(), 1e-14);
  EXPECT_LT((before.position - after.position).norm(), 1e-14);

  Eigen::Vector3d angular[2], linear[2], angular_near[2], linear_near[2];
  const double h = 1e-6;
  spline.Velocity(0, 1.0, &angular[0], &linear[0]);
  spline.Velocity(1, 0.0, &angular[1], &linear[1]);
  EXPECT_LT((angular[0] - angular[1]).norm(), 1e-13);
  EXPECT_LT((linear[0] - linear[1]).norm(), 1e-13);
  spline.Velocity(0, 1.0 - h, &angular_near[0], &linear_near[0]);
  spline.Velocity(1, h, &angular_near[1], &linear_near[1]);
  // One-sided differences: off by h times the third derivative, which is of order one.
  const Eigen::Vector3d angular_jump =
      (angular[0] - angular_near[0]) / h - (angular_near[1] - angular[1]) / h;
  const Eigen::Vector3d linear_jump =
      (linear[0] - linear_near[0]) / h - (linear_near[1] - linear[1]) / h;
  EXPECT_LT(angular_jump.norm(), 1e-4);
  EXPECT_LT(linear_jump.norm(), 1e-4);
}

TEST(Spline, VelocityIsDerivativeOfPose) {
  const TestSpline spline(4, 0.7, 29);
  const double h = 1e-6, u = 0.6, interval = 0.125;
  Eigen::Vector3d angular, linear;
  EvaluateVelocity(
      spline.Rotations(0).data(), spline.Positions(0).data(), u, interval, &angular, &linear);
  const SplinePose plus = spline.Pose(0, u + h);
  const SplinePose minus = spline.Pose(0, u - h);
  const double span = 2 * h * interval;
  EXPECT_LT(
      (angular - LeftDifference(plus.world_from_body, minus.world_from_body) / span).norm(),
      1e-7);
  EXPECT_LT((linear - (plus.position - minus.position) / span).norm(), 1e-7);
}

TEST(Spline, ConstantVelocityIsReproducedExactly) {
  TestSpline spline(4, 0.0, 31);
  const Eigen::Vector3d rate(0.4, -0.7, 1.1), speed(1.0, 2.0, -0.5);
  const Eigen::Quaterniond start = spline.q[1];
  for (int j = 0; j < 4; ++j) {
    // Control point j stands for the instant j - 1.
    spline.q[static_cast<size_t>(j)] = Exp((j - 1) * rate) * start;
    spline.p[static_cast<size_t>(j)] = (j - 1) * speed;
  }
  for (const double u : {0.0, 0.25, 0.99}) {
    const SplinePose pose = spline.Pose(0, u);
    EXPECT_LT(LeftDifference(pose.world_from_body, Exp(u * rate) * start).norm(), 1e-14);
    EXPECT_LT((pose.position - u * speed).norm(), 1e-14);
    Eigen::Vector3d angular, linear;
    spline.Velocity(0, u, &angular, &linear);
    EXPECT_LT((angular - rate).norm(), 1e-14);
    EXPECT_LT((linear - speed).norm(), 1e-14);
  }
}

TEST(Spline, ControlPointsOutsideTheSupportHaveNoEffect) {
  TestSpline spline(6, 0.5, 37);
  const SplinePose pose = spline.Pose(1, 0.4);
  for (const size_t outside : {0, 5}) {
    spline.q[outside] = Exp(Eigen::Vector3d(1.0, 1.0, 1.0));
    spline.p[outside].setConstant(100.0);
  }
  const SplinePose same = spline.Pose(1, 0.4);
  EXPECT_EQ(pose.world_from_body.coeffs(), same.world_from_body.coeffs());
  EXPECT_EQ(pose.position, same.position);
  // The first and the last one inside do have one.
  spline.p[1].x() += 1.0;
  spline.p[4].y() += 1.0;
  EXPECT_GT(std::abs(spline.Pose(1, 0.4).position.x() - pose.position.x()), 1e-3);
  EXPECT_GT(std::abs(spline.Pose(1, 0.4).position.y() - pose.position.y()), 1e-3);
}

TEST(Spline, SignOfAControlPointDoesNotMatter) {
  TestSpline spline(4, 0.5, 41);
  const SplinePose pose = spline.Pose(0, 0.4);
  spline.q[2].coeffs() *= -1.0;
  EXPECT_LT(LeftDifference(spline.Pose(0, 0.4).world_from_body, pose.world_from_body).norm(),
            1e-14);
}

}  // namespace
}  // namespace plumbline
