#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

#include "factors/spline/so3.h"

namespace plumbline {

// Uniform cubic B-spline of position and rotation over four control points, u in [0, 1):
//   p(u) = sum_j b_j(u) p_j
//   R(u) = R_0 Exp(B_1(u) d_1) Exp(B_2(u) d_2) Exp(B_3(u) d_3),   d_j = Log(R_{j-1}^-1 R_j)
// with the basis b and its tail sums B_j = b_j + ... + b_3. Interval i of a longer spline uses
// the control points i .. i+3; both parts are twice continuously differentiable across knots.
// Rotations are world_from_body, quaternions stored (x, y, z, w); the sign of a control point
// does not matter. Neighbouring control points must be less than pi apart.

inline constexpr int kSplineOrder = 4;

// b_0 .. b_3; they sum to one.
inline std::array<double, 4> SplineBasis(double u) {
  const double v = 1.0 - u;
  return {v * v * v / 6.0,
          (4.0 + u * u * (3.0 * u - 6.0)) / 6.0,
          (1.0 + u * (3.0 + u * (3.0 - 3.0 * u))) / 6.0,
          u * u * u / 6.0};
}

// B_0 = 1, B_1, B_2, B_3.
inline std::array<double, 4> CumulativeSplineBasis(double u) {
  return {1.0,
          (5.0 + u * (3.0 + u * (u - 3.0))) / 6.0,
          (1.0 + u * (3.0 + u * (3.0 - 2.0 * u))) / 6.0,
          u * u * u / 6.0};
}

// Derivative of CumulativeSplineBasis with respect to u.
inline std::array<double, 4> CumulativeSplineBasisDerivative(double u) {
  return {0.0, 0.5 * (1.0 + u * (u - 2.0)), 0.5 * (1.0 + u * (2.0 - 2.0 * u)), 0.5 * u * u};
}

// Evaluates R(u) into q_out, for functors that Ceres differentiates automatically.
template <typename T>
void EvaluateRotation(const T* const q[4], double u, T* q_out) {
  using Quaternion = Eigen::Quaternion<T>;
  using ConstMap = Eigen::Map<const Quaternion>;
  const std::array<double, 4> cumulative = CumulativeSplineBasis(u);
  Quaternion rotation = ConstMap(q[0]);
  for (int j = 1; j < 4; ++j) {
    const Quaternion step = ConstMap(q[j - 1]).conjugate() * ConstMap(q[j]);
    const Eigen::Matrix<T, 3, 1> increment = Log(step) * T(cumulative[j]);
    rotation = rotation * Exp(increment);
  }
  Eigen::Map<Quaternion>{q_out} = rotation;
}

// Evaluates p(u) into p_out, for functors that Ceres differentiates automatically.
template <typename T>
void EvaluatePosition(const T* const p[4], double u, T* p_out) {
  const std::array<double, 4> basis = SplineBasis(u);
  for (int axis = 0; axis < 3; ++axis) {
    p_out[axis] = basis[0] * p[0][axis] + basis[1] * p[1][axis] + basis[2] * p[2][axis] +
                  basis[3] * p[3][axis];
  }
}

struct SplinePose {
  Eigen::Quaterniond world_from_body = Eigen::Quaterniond::Identity();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // of the body in the world
};

struct SplinePoseJacobian {
  // Left tangent of the result with respect to the left tangent of rotation control point j.
  std::array<Eigen::Matrix3d, 4> rotation_wrt_control;
  // The position's derivative with respect to position control point j is this times identity.
  std::array<double, 4> position_weights;
};

// The step between two neighbouring rotation control points. It does not depend on u, so that
// several evaluations on the same control points share it.
struct RotationStep {
  Eigen::Vector3d vector;  // d_j = Log(R_{j-1}^-1 R_j), in the body frame of j-1
  double angle2 = 0.0;     // |d_j|^2
  double angle = 0.0;
  double inverse_jacobian = 0.0;    // the coefficient of [d]x^2 in LeftJacobianInverse(d_j)
  Eigen::Matrix3d body_from_world;  // R_{j-1}^-1
};

RotationStep MakeRotationStep(const double* q_previous, const double* q);

// Pose at u; jacobian may be null. q, p: four control points each.
SplinePose EvaluatePose(const double* const q[4],
                        const double* const p[4],
                        double u,
                        SplinePoseJacobian* jacobian);

// Evaluates the same pose, with the three steps between q[0] .. q[3] at hand.
SplinePose EvaluatePose(const RotationStep* steps,
                        const double* q0,
                        const double* const p[4],
                        double u,
                        SplinePoseJacobian* jacobian);

// Velocities at u: of the body's rotation (rad/s) and of its origin (m/s), both in the world
// frame.
void EvaluateVelocity(const double* const q[4],
                      const double* const p[4],
                      double u,
                      double knot_interval_s,
                      Eigen::Vector3d* angular_world,
                      Eigen::Vector3d* linear_world);

// Location of a node on the spline: it uses the control points first .. first + 3, counted
// from the factor's own first control point, at u in [0, 1).
struct SplineNode {
  int first = 0;
  double u = 0.0;
};

}  // namespace plumbline
