#pragma once

#include <Eigen/Core>

#include "factors/spline/spline.h"

namespace plumbline {

// RotationMotion is the body's rotation in time at an instant, in the body frame, with its
// derivatives by the vectors of the three steps between the control points (three columns
// each) and by u.
struct RotationMotion {
  using BySteps = Eigen::Matrix<double, 3, 9>;
  Eigen::Matrix3d body_from_first;  // first: the frame of the first control point
  BySteps turn_by_steps;            // of e with Exp(e) on the right of first_from_body
  Eigen::Vector3d rate;             // rad/s
  BySteps rate_by_steps;
  Eigen::Vector3d rate_by_u;
  Eigen::Vector3d acceleration;  // rad/s^2
  BySteps acceleration_by_steps;
  Eigen::Vector3d acceleration_by_u;
};

// The motion of three steps at u, which may lie somewhat outside of [0, 1). With the factors
// A_j = Exp(B_j d_j) of the rotation,
//   w_j = A_j^-1 w_{j-1} + B_j' d_j,   a_j = A_j^-1 a_{j-1} + B_j'' d_j + w_j x B_j' d_j
// (Sommer et al. 2020, "Efficient derivative computation for cumulative B-splines on Lie
// groups").
RotationMotion EvaluateRotationMotion(const RotationStep* steps,
                                      double u,
                                      double knot_interval_s);

}  // namespace plumbline
