#pragma once

#include <Eigen/Core>
#include <memory>

namespace ceres {
class CostFunction;
}

namespace plumbline {

// Weak priors on the motion: differences of neighbouring spline control points, differentiated
// automatically. For a cubic B-spline with knot interval h the second difference of the
// control points over h^2 is the acceleration at the knot, the first difference over h about
// the velocity. Three residuals each.

// MotionPersistence holds the shares that go on from one knot to the next, by world axis: of a
// velocity, 1 where it goes on but for accelerations, and of the acceleration that drives it.
struct MotionPersistence {
  Eigen::Vector3d velocity = Eigen::Vector3d::Ones();
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_velocity = Eigen::Vector3d::Zero();  // m/s, that velocities return to
};

// What drives the position, an acceleration where velocities go on, for k =
// persistence.velocity and m = persistence.mean_velocity:
//   r = ((p2 - p1 - m h) - k (p1 - p0 - m h)) / (stddev h^2),   stddev in m/s^2, by world
//   axis.
// Blocks: [ p0 | p1 | p2 ]
std::unique_ptr<ceres::CostFunction> CreatePositionAccelerationFactor(
    const Eigen::Vector3d& stddev,
    const MotionPersistence& persistence,
    double knot_interval_s);

// Angular acceleration:  r = (Log(q2 q1^-1) - Log(q1 q0^-1)) / (stddev h^2),  stddev in
// rad/s^2, by world axis: a rig that leans turns about the vertical. Blocks: [ q0 | q1 | q2 ]
std::unique_ptr<ceres::CostFunction> CreateRotationAccelerationFactor(
    const Eigen::Vector3d& stddev, double knot_interval_s);

// Innovation, the part of the acceleration a2, at the knot between p1 and p3, that does not follow
// from the one before, a1:
//   r = (a2 - persistence.acceleration a1) / stddev,   stddev in m/s^2, by world axis.
// Blocks: [ p0 | p1 | p2 | p3 ]
std::unique_ptr<ceres::CostFunction> CreatePositionInnovationFactor(
    const Eigen::Vector3d& stddev,
    const MotionPersistence& persistence,
    double knot_interval_s);

// Innovation of angular accelerations:
//   r = (a2 - persistence a1) / stddev,   stddev in rad/s^2, by world axis.
// Blocks: [ q0 | q1 | q2 | q3 ]
std::unique_ptr<ceres::CostFunction> CreateRotationInnovationFactor(
    const Eigen::Vector3d& stddev, double persistence, double knot_interval_s);

// Velocity:  r = (p1 - p0) / (stddev h),   stddev in m/s.
// Blocks: [ p0 | p1 ]
std::unique_ptr<ceres::CostFunction> CreatePositionVelocityFactor(double stddev,
                                                                  double knot_interval_s);

// Angular velocity:  r = Log(q1 q0^-1) / (stddev h),   stddev in rad/s.
// Blocks: [ q0 | q1 ]
std::unique_ptr<ceres::CostFunction> CreateRotationVelocityFactor(double stddev,
                                                                  double knot_interval_s);

}  // namespace plumbline
