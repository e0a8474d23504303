#include "factors/spline/spline.h"

#include <cmath>

namespace plumbline {
namespace {

using ConstQuaternion = Eigen::Map<const Eigen::Quaterniond>;
using ConstVector = Eigen::Map<const Eigen::Vector3d>;

Eigen::Vector3d Position(const double* const p[4], const std::array<double, 4>& basis) {
  return basis[0] * ConstVector(p[0]) + basis[1] * ConstVector(p[1]) +
         basis[2] * ConstVector(p[2]) + basis[3] * ConstVector(p[3]);
}

// sin(a)/a, (1 - cos a)/a^2 and (a - sin a)/a^3 for a >= 0: the coefficients of Exp and of
// LeftJacobian.
struct RotationCoefficients {
  double sine, cosine, third;

  RotationCoefficients(double a, double a2) {
    if (a2 < 0.06) {  // all terms that reach double precision here; the closed forms cancel
      third =
          1.0 / 6.0 + a2 * (-1.0 / 120.0 +
                            a2 * (1.0 / 5040.0 +
                                  a2 * (-1.0 / 362880.0 +
                                        a2 * (1.0 / 39916800.0 - a2 * (1.0 / 6227020800.0)))));
      cosine =
          0.5 +
          a2 * (-1.0 / 24.0 +
                a2 * (1.0 / 720.0 + a2 * (-1.0 / 40320.0 +
                                          a2 * (1.0 / 3628800.0 - a2 * (1.0 / 479001600.0)))));
      sine = 1.0 - a2 * third;
    } else {
      const double s = std::sin(a);
      sine = s / a;
      cosine = (1.0 - std::cos(a)) / a2;
      third = (a - s) / (a2 * a);
    }
  }
};

// identity I + first [d]x + second [d]x^2, using [d]x^2 = d d^T - |d|^2 I.
Eigen::Matrix3d SkewPolynomial(const Eigen::Vector3d& d,
                               double angle2,
                               double first,
                               double second) {
  const double diagonal = 1.0 - second * angle2;
  const Eigen::Vector3d f = first * d;
  const Eigen::Vector3d s = second * d;
  const double xy = s.x() * d.y();
  const double xz = s.x() * d.z();
  const double yz = s.y() * d.z();
  Eigen::Matrix3d m;
  m << diagonal + s.x() * d.x(), xy - f.z(), xz + f.y(),  //
      xy + f.z(), diagonal + s.y() * d.y(), yz - f.x(),   //
      xz - f.y(), yz + f.x(), diagonal + s.z() * d.z();
  return m;
}

}  // namespace

RotationStep MakeRotationStep(const double* q_previous, const double* q) {
  RotationStep step;
  const Eigen::Quaterniond inverse = ConstQuaternion(q_previous).conjugate();
  step.vector = Log(inverse * ConstQuaternion(q));
  step.angle2 = step.vector.squaredNorm();
  step.angle = std::sqrt(step.angle2);
  const double a2 = step.angle2;
  if (a2 < 0.01) {
    step.inverse_jacobian =
        1.0 / 12.0 + a2 * (1.0 / 720.0 + a2 * (1.0 / 30240.0 + a2 / 1209600.0));
  } else {
    const double half = 0.5 * step.angle;
    step.inverse_jacobian = (1.0 - half * std::cos(half) / std::sin(half)) / a2;
  }
  step.body_from_world = inverse.toRotationMatrix();
  return step;
}

SplinePose EvaluatePose(const RotationStep* steps,
                        const double* q0,
                        const double* const p[4],
                        double u,
                        SplinePoseJacobian* jacobian) {
  const std::array<double, 4> basis = SplineBasis(u);
  const std::array<double, 4> cumulative = CumulativeSplineBasis(u);
  SplinePose pose;
  pose.position = Position(p, basis);
  if (jacobian == nullptr) {
    pose.world_from_body = ConstQuaternion(q0);
    for (int j = 1; j < 4; ++j) {
      pose.world_from_body = pose.world_from_body * Exp(cumulative[j] * steps[j - 1].vector);
    }
    return pose;
  }
  jacobian->position_weights = basis;
  // With P_{j-1} = R_0 Exp(B_1 d_1) .. Exp(B_{j-1} d_{j-1}) and left tangents e_j of the
  // control points, the left tangent of R(u) is e_0 + sum_j K_j (e_j - e_{j-1}),
  //   K_j = B_j P_{j-1} LeftJacobian(B_j d_j) LeftJacobianInverse(d_j) R_{j-1}^-1 .
  // Both Jacobians are polynomials in [d]x; with [d]x^3 = -|d|^2 [d]x so is their product.
  Eigen::Matrix3d product = steps[0].body_from_world.transpose();
  jacobian->rotation_wrt_control[0].setIdentity();
  for (int j = 1; j < 4; ++j) {
    const RotationStep& step = steps[j - 1];
    const double b = cumulative[j];
    const double a2 = step.angle2;
    const RotationCoefficients c(b * step.angle, b * b * a2);
    const double left1 = b * c.cosine;
    const double left2 = b * b * c.third;
    const double inverse2 = step.inverse_jacobian;
    const double first = left1 - 0.5 + a2 * (0.5 * left2 - left1 * inverse2);
    const double second = left2 + inverse2 - 0.5 * left1 - a2 * left2 * inverse2;
    const Eigen::Matrix3d k = (product * SkewPolynomial(step.vector, a2, first, second)) *
                              (b * step.body_from_world);
    jacobian->rotation_wrt_control[j] = k;
    jacobian->rotation_wrt_control[j - 1] -= k;
    product = product * SkewPolynomial(step.vector, a2, b * c.sine, b * left1);
  }
  pose.world_from_body = Eigen::Quaterniond(product);
  return pose;
}

SplinePose EvaluatePose(const double* const q[4],
                        const double* const p[4],
                        double u,
                        SplinePoseJacobian* jacobian) {
  const RotationStep steps[3] = {MakeRotationStep(q[0], q[1]),
                                 MakeRotationStep(q[1], q[2]),
                                 MakeRotationStep(q[2], q[3])};
  return EvaluatePose(steps, q[0], p, u, jacobian);
}

void EvaluateVelocity(const double* const q[4],
                      const double* const p[4],
                      double u,
                      double knot_interval_s,
                      Eigen::Vector3d* angular_world,
                      Eigen::Vector3d* linear_world) {
  const std::array<double, 4> cumulative = CumulativeSplineBasis(u);
  const std::array<double, 4> derivative = CumulativeSplineBasisDerivative(u);
  // d/dt of the product: factor j turns at B_j' d_j, seen from the world through P_{j-1}.
  Eigen::Quaterniond product = ConstQuaternion(q[0]);
  angular_world->setZero();
  linear_world->setZero();
  for (int j = 1; j < 4; ++j) {
    const Eigen::Vector3d d =
        Log(ConstQuaternion(q[j - 1]).conjugate() * ConstQuaternion(q[j]));
    const double rate = derivative[j] / knot_interval_s;
    *angular_world += rate * (product * d);
    *linear_world += rate * (ConstVector(p[j]) - ConstVector(p[j - 1]));
    product = product * Exp(cumulative[j] * d);
  }
}

}  // namespace plumbline
