#include "core/trajectory/trajectory.h"

#include <gtest/gtest.h>

#include "core/util/error.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'400'000'000'000'000'123;
constexpr int64_t kInterval = 125'000'000;

Rigid3d StartPose() {
  return {RotationFromRollPitchYaw(0.2, -0.3, 2.5), Eigen::Vector3d(1.0, -2.0, 0.5)};
}

// Control points on a straight line at constant speed and turn rate.
Trajectory MakeSteady(const Eigen::Vector3d& step, const Eigen::Vector3d& turn) {
  Trajectory trajectory(kStart, kInterval, StartPose());
  Eigen::Quaterniond rotation = StartPose().rotation;
  const Eigen::Quaterniond turn_rotation(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  for (int i = 0; i < 4; ++i) {
    ControlPoint& control_point = trajectory.control_point(i);
    Eigen::Map<Eigen::Vector3d>(control_point.position.data()) += i * step;
    Eigen::Map<Eigen::Quaterniond>(control_point.rotation.data()) = rotation;
    rotation = rotation * turn_rotation;
  }
  return trajectory;
}

TEST(TrajectoryTest, IsAtRestAtFirst) {
  const Trajectory trajectory(kStart, kInterval, StartPose());
  EXPECT_EQ(trajectory.num_control_points(), 4);
  EXPECT_EQ(trajectory.end_ns(), kStart + kInterval);
  for (const int64_t time_ns : {kStart, kStart + kInterval / 3, kStart + kInterval - 1}) {
    const Rigid3d pose = trajectory.WorldFromBody(time_ns);
    EXPECT_LT((pose.translation - StartPose().translation).norm(), 1e-12);
    EXPECT_LT(pose.rotation.angularDistance(StartPose().rotation), 1e-12);
    Eigen::Vector3d angular, linear;
    trajectory.Velocity(time_ns, &angular, &linear);
    EXPECT_LT(angular.norm() + linear.norm(), 1e-12);
  }
}

TEST(TrajectoryTest, RefusesInstantsOutsideItsRange) {
  Trajectory trajectory(kStart, kInterval, StartPose());
  Eigen::Vector3d angular, linear;
  for (const int64_t time_ns : {kStart - 1, kStart + kInterval, kStart + 1000 * kInterval}) {
    EXPECT_THROW(trajectory.Locate(time_ns), Error);
    EXPECT_THROW(trajectory.WorldFromBody(time_ns), Error);
    EXPECT_THROW(trajectory.Velocity(time_ns, &angular, &linear), Error);
  }
  trajectory.ExtendTo(kStart + kInterval);
  EXPECT_NO_THROW(trajectory.WorldFromBody(kStart + kInterval));
  EXPECT_THROW(trajectory.WorldFromBody(kStart + 2 * kInterval), Error);
}

TEST(TrajectoryTest, LocatesInstantsToTheNanosecond) {
  Trajectory trajectory(kStart, kInterval, StartPose());
  trajectory.ExtendTo(kStart + 9 * kInterval);
  EXPECT_EQ(trajectory.Locate(kStart).first, 0);
  EXPECT_EQ(trajectory.Locate(kStart).u, 0.0);
  EXPECT_EQ(trajectory.Locate(kStart + 3 * kInterval - 1).first, 2);
  EXPECT_LT(trajectory.Locate(kStart + 3 * kInterval - 1).u, 1.0);
  EXPECT_EQ(trajectory.Locate(kStart + 3 * kInterval).first, 3);
  EXPECT_NEAR(trajectory.Locate(kStart + 3 * kInterval + kInterval / 4).u, 0.25, 1e-12);
}

TEST(TrajectoryTest, ExtendsAtConstantVelocity) {
  const Eigen::Vector3d step(0.1, -0.02, 0.03);
  const Eigen::Vector3d turn(0.01, -0.02, 0.15);
  Trajectory trajectory = MakeSteady(step, turn);
  const ControlPoint* first = &trajectory.control_point(0);
  trajectory.ExtendTo(kStart + 40 * kInterval);
  EXPECT_EQ(&trajectory.control_point(0), first) << "solvers hold pointers";
  EXPECT_EQ(trajectory.num_control_points(), 44);
  EXPECT_EQ(trajectory.end_ns(), kStart + 41 * kInterval);
  const int count = trajectory.num_control_points();
  trajectory.ExtendTo(kStart);
  EXPECT_EQ(trajectory.num_control_points(), count);

  Eigen::Vector3d angular_start, linear_start, angular_end, linear_end;
  trajectory.Velocity(kStart, &angular_start, &linear_start);
  trajectory.Velocity(kStart + 40 * kInterval, &angular_end, &linear_end);
  EXPECT_LT((linear_end - step / 0.125).norm(), 1e-9);
  EXPECT_LT((linear_end - linear_start).norm(), 1e-9);
  // The axis of the turn is fixed in the body and, as it is the only turn, in the world.
  const Eigen::Vector3d turn_world = StartPose().rotation * turn / 0.125;
  EXPECT_LT((angular_start - turn_world).norm(), 1e-9);
  EXPECT_LT((angular_end - turn_world).norm(), 1e-9);
  const Rigid3d start = trajectory.WorldFromBody(kStart);
  const Rigid3d end = trajectory.WorldFromBody(kStart + 40 * kInterval);
  EXPECT_LT((end.translation - start.translation - 40 * step).norm(), 1e-9);
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(40 * turn.norm(), turn.normalized()));
  EXPECT_LT(end.rotation.angularDistance(start.rotation * turned), 1e-9);
}

TEST(TrajectoryTest, VelocityIsTheDerivativeOfThePose) {
  Trajectory trajectory = MakeSteady({0.1, 0.0, 0.0}, {0.0, 0.0, 0.2});
  for (int i = 0; i < 4; ++i) {
    ControlPoint& control_point = trajectory.control_point(i);
    control_point.position[1] += 0.05 * i * i;
    Eigen::Map<Eigen::Quaterniond> rotation(control_point.rotation.data());
    rotation = rotation * RotationFromRollPitchYaw(0.03 * i * i, -0.02 * i, 0.05 * i);
    rotation.normalize();
  }
  const int64_t step_ns = 10'000;
  for (const int64_t since_start : {kInterval / 5, kInterval / 2, 4 * kInterval / 5}) {
    const int64_t time_ns = kStart + since_start;
    const Rigid3d before = trajectory.WorldFromBody(time_ns - step_ns);
    const Rigid3d after = trajectory.WorldFromBody(time_ns + step_ns);
    const double step_s = SecondsBetween(time_ns - step_ns, time_ns + step_ns);
    Eigen::Vector3d angular, linear;
    trajectory.Velocity(time_ns, &angular, &linear);
    EXPECT_LT((linear - (after.translation - before.translation) / step_s).norm(), 1e-6);
    const Eigen::AngleAxisd turn(after.rotation * before.rotation.conjugate());
    EXPECT_LT((angular - turn.angle() / step_s * turn.axis()).norm(), 1e-6);
  }
}

TEST(TrajectoryTest, MovesToAnotherWorld) {
  Trajectory trajectory = MakeSteady({0.1, 0.05, -0.02}, {0.05, 0.1, -0.2});
  const int64_t time_ns = kStart + kInterval / 3;
  const Rigid3d before = trajectory.WorldFromBody(time_ns);
  const Rigid3d to_from(RotationFromRollPitchYaw(0.0, 0.0, 1.2), {3.0, -4.0, 0.7});
  trajectory.Move(to_from);
  const Rigid3d difference = trajectory.WorldFromBody(time_ns) * (to_from * before).Inverse();
  EXPECT_LT(difference.translation.norm(), 1e-12);
  EXPECT_LT(difference.rotation.angularDistance(Eigen::Quaterniond::Identity()), 1e-7);
}

// Two trajectories of one steady motion and with the same knots, ten intervals apart.
TEST(TrajectoryTest, GoesOnWithALaterOneAcrossAGap) {
  const Eigen::Vector3d step(0.1, 0.05, -0.02);
  Trajectory trajectory = MakeSteady(step, {0.0, 0.0, 1e-9});
  Trajectory whole = trajectory;
  whole.ExtendTo(kStart + 13 * kInterval);
  Trajectory later(kStart + 10 * kInterval, kInterval, StartPose());
  for (int i = 0; i < 4; ++i) later.control_point(i) = whole.control_point(10 + i);
  trajectory.Append(later);
  EXPECT_EQ(trajectory.end_ns(), later.end_ns());
  ASSERT_EQ(trajectory.num_control_points(), 14);
  for (int i = 0; i < 14; ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(trajectory.control_point(i).position[static_cast<size_t>(k)],
                  whole.control_point(i).position[static_cast<size_t>(k)],
                  1e-9);
    }
  }
}

// Where both have control points, the later one's stay.
TEST(TrajectoryTest, GoesOnWithALaterOneThatOverlaps) {
  Trajectory trajectory(kStart, kInterval, StartPose());
  trajectory.ExtendTo(kStart + 5 * kInterval);
  const Rigid3d elsewhere(Eigen::Quaterniond::Identity(), {7.0, 8.0, 9.0});
  const Trajectory later(kStart + 6 * kInterval, kInterval, elsewhere);
  trajectory.Append(later);
  EXPECT_EQ(trajectory.end_ns(), later.end_ns());
  EXPECT_NEAR(trajectory.control_point(5).position[0], StartPose().translation.x(), 1e-12);
  EXPECT_NEAR(trajectory.control_point(6).position[0], 7.0, 1e-12);
}

}  // namespace
}  // namespace plumbline
