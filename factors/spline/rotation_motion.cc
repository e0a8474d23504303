#include "factors/spline/rotation_motion.h"

#include <array>

#include "factors/spline/so3.h"

namespace plumbline {

RotationMotion EvaluateRotationMotion(const RotationStep* steps,
                                      double u,
                                      double knot_interval_s) {
  const double per_s = 1.0 / knot_interval_s;
  const double per_s2 = per_s * per_s;
  const std::array<double, 4> cumulative = CumulativeSplineBasis(u);
  const std::array<double, 4> by_u = CumulativeSplineBasisDerivative(u);
  const std::array<double, 3> by_u2 = {u - 1.0, 1.0 - 2.0 * u, u};
  const std::array<double, 3> by_u3 = {1.0, -2.0, 1.0};
  RotationMotion motion;
  motion.body_from_first.setIdentity();
  for (Eigen::Vector3d* vector :
       {&motion.rate, &motion.rate_by_u, &motion.acceleration, &motion.acceleration_by_u}) {
    vector->setZero();
  }
  for (int j = 0; j < 3; ++j) {
    const auto at = static_cast<size_t>(j);
    const Eigen::Vector3d& d = steps[j].vector;
    const double b = cumulative[at + 1];
    const double b1 = by_u[at + 1] * per_s;
    const double b2 = by_u2[at] * per_s2;
    const Eigen::Vector3d own_rate = b1 * d;
    const Eigen::Matrix3d back = Exp(b * d).conjugate().toRotationMatrix();
    // A factor's turn on its right, by its step.
    const Eigen::Matrix3d turn = b * LeftJacobian(-b * d);
    // What the steps before have brought, in the frame behind this one.
    for (RotationMotion::BySteps* matrix :
         {&motion.turn_by_steps, &motion.rate_by_steps, &motion.acceleration_by_steps}) {
      for (int k = 0; k < j; ++k) {
        matrix->middleCols<3>(3 * k) = back * matrix->middleCols<3>(3 * k);
      }
    }
    motion.body_from_first = back * motion.body_from_first;
    motion.turn_by_steps.middleCols<3>(3 * j) = turn;
    const Eigen::Vector3d rate = back * motion.rate;
    motion.rate = rate + own_rate;
    motion.rate_by_steps.middleCols<3>(3 * j) = SkewMatrix(rate) * turn;
    motion.rate_by_steps.middleCols<3>(3 * j).diagonal().array() += b1;
    motion.rate_by_u =
        back * motion.rate_by_u + by_u[at + 1] * rate.cross(d) + by_u2[at] * per_s * d;
    const Eigen::Vector3d acceleration = back * motion.acceleration;
    motion.acceleration = acceleration + b2 * d + motion.rate.cross(own_rate);
    motion.acceleration_by_steps.middleCols<3>(3 * j) =
        SkewMatrix(acceleration) * turn + b1 * SkewMatrix(motion.rate);
    motion.acceleration_by_steps.middleCols<3>(3 * j).diagonal().array() += b2;
    const Eigen::Matrix3d across = SkewMatrix(own_rate);
    for (int k = 0; k <= j; ++k) {
      motion.acceleration_by_steps.middleCols<3>(3 * k) -=
          across * motion.rate_by_steps.middleCols<3>(3 * k);
    }
    motion.acceleration_by_u = back * motion.acceleration_by_u +
                               by_u[at + 1] * acceleration.cross(d) + by_u3[at] * per_s2 * d +
                               motion.rate_by_u.cross(own_rate) +
                               by_u2[at] * per_s * motion.rate.cross(d);
  }
  return motion;
}

}  // namespace plumbline
