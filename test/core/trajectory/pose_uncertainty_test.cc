#include "core/trajectory/pose_uncertainty.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "core/trajectory/pose_gaussian.h"

namespace plumbline {
namespace {

constexpr int64_t kStartNs = 1'400'000'000'000'000'000;
constexpr int64_t kKnotNs = 100'000'000;
constexpr int kNumControlPoints = 6;

// A body that walks and turns about all axes.
Trajectory Walk() {
  Trajectory trajectory(kStartNs, kKnotNs, Rigid3d());
  trajectory.ExtendTo(kStartNs + 2 * kKnotNs);
  for (int i = 0; i < kNumControlPoints; ++i) {
    ControlPoint& point = trajectory.control_point(i);
    point.position = {0.1 * i, 0.02 * i * i, -0.01 * i};
    Eigen::Map<Eigen::Quaterniond>(point.rotation.data()) =
        Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * i, Eigen::Vector3d::UnitZ()) *
                           Eigen::AngleAxisd(0.05 * i * i, Eigen::Vector3d::UnitX()));
  }
  return trajectory;
}

// Any covariance of all control points.
Eigen::MatrixXd SomeCovariance(int num_control_points) {
  const Eigen::Index size = kPoseSize * num_control_points;
  Eigen::MatrixXd root(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      root(i, j) = std::sin(0.7 * static_cast<double>((i + 1) * (j * j + 2)));
    }
  }
  return 1e-4 * root * root.transpose();
}

// Derivative of the pose (world-frame rotation and position) by all control points, by
// differences.
Eigen::MatrixXd NumericalJacobian(const Trajectory& trajectory, int64_t time_ns) {
  constexpr double kStep = 1e-6;
  const Rigid3d pose = trajectory.WorldFromBody(time_ns);
  Eigen::MatrixXd jacobian(6, kPoseSize * kNumControlPoints);
  for (int column = 0; column < jacobian.cols(); ++column) {
    Trajectory moved = trajectory;
    ControlPoint& point = moved.control_point(column / kPoseSize);
    const int k = column % kPoseSize;
    if (k < 3) {
      Eigen::Map<Eigen::Quaterniond> rotation(point.rotation.data());
      rotation = Eigen::AngleAxisd(kStep, Eigen::Vector3d::Unit(k)) * rotation;
    } else {
      point.position[static_cast<size_t>(k - 3)] += kStep;
    }
    const Rigid3d changed = moved.WorldFromBody(time_ns);
    const Eigen::AngleAxisd turn(changed.rotation * pose.rotation.conjugate());
    jacobian.col(column) << turn.angle() * turn.axis() / kStep,
        (changed.translation - pose.translation) / kStep;
  }
  return jacobian;
}

TEST(PoseUncertaintyTest, IsTheCovarianceBehindThePosesDerivative) {
  const Trajectory trajectory = Walk();
  const Eigen::MatrixXd covariance = SomeCovariance(kNumControlPoints);
  const PoseUncertainty uncertainty(0, covariance);
  for (const int64_t time_ns :
       {kStartNs, kStartNs + kKnotNs / 3, kStartNs + 2 * kKnotNs + kKnotNs / 2}) {
    const Eigen::MatrixXd jacobian = NumericalJacobian(trajectory, time_ns);
    const Matrix6d expected = jacobian * covariance * jacobian.transpose();
    EXPECT_LT((uncertainty.At(trajectory, time_ns) - expected).norm(), 1e-5 * expected.norm());
  }
}

TEST(PoseUncertaintyTest, TwoPosesHaveAJointCovariance) {
  const Trajectory trajectory = Walk();
  const Eigen::MatrixXd covariance = SomeCovariance(kNumControlPoints);
  const int64_t first_ns = kStartNs + kKnotNs / 5;
  const int64_t second_ns = kStartNs + 2 * kKnotNs;
  Eigen::MatrixXd jacobian(12, covariance.cols());
  jacobian << NumericalJacobian(trajectory, first_ns),
      NumericalJacobian(trajectory, second_ns);
  const Eigen::MatrixXd expected = jacobian * covariance * jacobian.transpose();
  const Eigen::MatrixXd joint =
      PoseUncertainty(0, covariance).AtBoth(trajectory, first_ns, second_ns);
  EXPECT_LT((joint - expected).norm(), 1e-5 * expected.norm());
  EXPECT_LT((joint - joint.transpose()).norm(), 1e-12 * joint.norm());
}

// Control points before the covariance's first, and behind its last, are held.
TEST(PoseUncertaintyTest, ControlPointsWithoutRowsAreHeld) {
  const Trajectory trajectory = Walk();
  const int first = 2, num = 2;
  Eigen::MatrixXd whole =
      Eigen::MatrixXd::Zero(kPoseSize * kNumControlPoints, kPoseSize * kNumControlPoints);
  const Eigen::MatrixXd part = SomeCovariance(num);
  whole.block(kPoseSize * first, kPoseSize * first, part.rows(), part.cols()) = part;
  for (const int64_t time_ns : {kStartNs, kStartNs + kKnotNs + 1, kStartNs + 2 * kKnotNs}) {
    EXPECT_LT((PoseUncertainty(first, part).At(trajectory, time_ns) -
               PoseUncertainty(0, whole).At(trajectory, time_ns))
                  .norm(),
              1e-15);
  }
  EXPECT_EQ(PoseUncertainty().At(trajectory, kStartNs).norm(), 0.0);
}

// Where all control points are off by one shift and one turn, every pose is.
TEST(PoseUncertaintyTest, CommonErrorIsThatOfEveryPose) {
  const Trajectory trajectory = Walk();
  Matrix6d shared = SomeCovariance(1);
  shared.topRightCorner<3, 3>().setZero();
  shared.bottomLeftCorner<3, 3>().setZero();
  const Eigen::MatrixXd covariance = shared.replicate(kNumControlPoints, kNumControlPoints);
  const Eigen::Matrix<double, 12, 12> joint =
      PoseUncertainty(0, covariance)
          .AtBoth(trajectory, kStartNs + kKnotNs / 3, kStartNs + 2 * kKnotNs);
  EXPECT_LT((joint - shared.replicate(2, 2)).norm(), 1e-12 * shared.norm());
}

}  // namespace
}  // namespace plumbline
