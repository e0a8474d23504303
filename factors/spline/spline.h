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

// Rotation of a spline and its derivatives; the rotation is from the body to the frame of the
// first control point.
template <typename T>
struct SplineMotion {
  Eigen::Quaternion<T> first_from_body;
  Eigen::Matrix<T, 3, 1> rate_body;                  // rad/s
  Eigen::Matrix<T, 3, 1> angular_acceleration_body;  // rad/s^2
};

// The rotation vector (rad) from one control point to the next.
template <typename T>
Eigen::Matrix<T, 3, 1> StepBetween(const T* from, const T* to) {
  using ConstMap = Eigen::Map<const Eigen::Quaternion<T>>;
  return Log(ConstMap(from).conjugate() * ConstMap(to));
}

// The steps d_j between the four control points.
template <typename T>
std::array<Eigen::Matrix<T, 3, 1>, 3> RotationSteps(const T* const q[4]) {
  return {StepBetween(q[0], q[1]), StepBetween(q[1], q[2]), StepBetween(q[2], q[3])};
}

// The motion of these steps at u, which may be a Jet and lie somewhat outside of [0, 1). With
// the factors A_j = Exp(B_j d_j) of the rotation,
//   w_j = A_j^-1 w_{j-1} + B_j' d_j,   a_j = A_j^-1 a_{j-1} + B_j'' d_j + w_j x B_j' d_j
// (Sommer et al. 2020, "Efficient derivative computation for cumulative B-splines on Lie
// groups"). kRateOnly: the other members are not set.
template <bool kRateOnly = false, typename T>
SplineMotion<T> EvaluateRotationMotion(const std::array<Eigen::Matrix<T, 3, 1>, 3>& steps,
                                       const T& u,
                                       double knot_interval_s) {
  using Quaternion = Eigen::Quaternion<T>;
  using Vector3 = Eigen::Matrix<T, 3, 1>;
  const double per_s = 1.0 / knot_interval_s;
  const T cumulative[3] = {(5.0 + u * (3.0 + u * (u - 3.0))) / 6.0,
                           (1.0 + u * (3.0 + u * (3.0 - 2.0 * u))) / 6.0,
                           u * u * u / 6.0};
  const T first[3] = {
      0.5 * (1.0 + u * (u - 2.0)), 0.5 * (1.0 + u * (2.0 - 2.0 * u)), 0.5 * u * u};
  const T second[3] = {u - 1.0, 1.0 - 2.0 * u, u};
  SplineMotion<T> motion;
  for (size_t j = 0; j < 3; ++j) {
    const Vector3& d = steps[j];
    const Vector3 rate = d * T(first[j] * per_s);
    const Vector3 push = d * T(second[j] * per_s * per_s);
    if (j == 0) {  // it turns about its own rate
      motion.rate_body = rate;
      if (kRateOnly) continue;
      motion.first_from_body = Exp(Vector3(d * cumulative[j]));
      motion.angular_acceleration_body = push;
      continue;
    }
    const Quaternion factor = Exp(Vector3(d * cumulative[j]));
    const Quaternion back = factor.conjugate();
    motion.rate_body = Vector3(back * motion.rate_body) + rate;
    if (kRateOnly) continue;
    motion.first_from_body = motion.first_from_body * factor;
    motion.angular_acceleration_body =
        Vector3(back * motion.angular_acceleration_body) + push + motion.rate_body.cross(rate);
  }
  return motion;
}

// Acceleration of the position at u, m/s^2 in the world; u as above.
template <typename T>
Eigen::Matrix<T, 3, 1> EvaluateAcceleration(const T* const p[4],
                                            const T& u,
                                            double knot_interval_s) {
  const double per_s2 = 1.0 / (knot_interval_s * knot_interval_s);
  const T weights[4] = {1.0 - u, 3.0 * u - 2.0, 1.0 - 3.0 * u, u};
  Eigen::Matrix<T, 3, 1> acceleration;
  for (int axis = 0; axis < 3; ++axis) {
    acceleration[axis] = per_s2 * (weights[0] * p[0][axis] + weights[1] * p[1][axis] +
                                   weights[2] * p[2][axis] + weights[3] * p[3][axis]);
  }
  return acceleration;
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
