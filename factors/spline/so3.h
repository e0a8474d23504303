#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace plumbline {

// Rotations as unit quaternions and rotation vectors (rad).
//   Exp(d): turn by |d| about d.     Log(Exp(d)) = d for |d| <= pi.
// Everywhere in plumbline the tangent of a rotation is a LEFT perturbation: q <- Exp(delta) *
// q, so that delta is expressed in the frame that q maps to. Exp and Log accept Jets and have
// exact derivatives at zero.

template <typename Derived>
Eigen::Quaternion<typename Derived::Scalar> Exp(const Eigen::MatrixBase<Derived>& vector) {
  using T = typename Derived::Scalar;
  using std::cos;
  using std::sin;
  using std::sqrt;
  const Eigen::Matrix<T, 3, 1> d = vector;
  const T angle2 = d.squaredNorm();
  T factor;  // sin(angle / 2) / angle
  T w;
  if (angle2 < 0.06) {  // all terms that reach double precision; cheaper than the functions
    const T half2 = 0.25 * angle2;
    factor = 0.5 - half2 * (1.0 / 12.0 - half2 * (1.0 / 240.0 -
                                                  half2 * (1.0 / 10080.0 - half2 / 725760.0)));
    w = 1.0 - half2 * (0.5 - half2 * (1.0 / 24.0 -
                                      half2 * (1.0 / 720.0 -
                                               half2 * (1.0 / 40320.0 - half2 / 3628800.0))));
  } else {
    const T angle = sqrt(angle2);
    factor = sin(0.5 * angle) / angle;
    w = cos(0.5 * angle);
  }
  return Eigen::Quaternion<T>(w, factor * d[0], factor * d[1], factor * d[2]);
}

// The shortest rotation vector: q and -q give the same, its length is at most pi. The length
// of q does not matter.
template <typename Derived>
Eigen::Matrix<typename Derived::Scalar, 3, 1> Log(const Eigen::QuaternionBase<Derived>& q) {
  using T = typename Derived::Scalar;
  using std::atan2;
  using std::sqrt;
  const bool flip = q.w() < 0.0;
  const T w = flip ? T(-q.w()) : T(q.w());
  const Eigen::Matrix<T, 3, 1> v =
      flip ? Eigen::Matrix<T, 3, 1>(-q.vec()) : Eigen::Matrix<T, 3, 1>(q.vec());
  const T sine2 = v.squaredNorm();
  T factor;  // angle / sin(angle / 2)
  const T tangent2 = sine2 / (w * w);
  if (sine2 < 0.01 * w * w) {  // all terms that reach double precision
    factor =
        2.0 / w *
        (1.0 - tangent2 *
                   (1.0 / 3.0 -
                    tangent2 *
                        (1.0 / 5.0 -
                         tangent2 *
                             (1.0 / 7.0 -
                              tangent2 *
                                  (1.0 / 9.0 -
                                   tangent2 * (1.0 / 11.0 -
                                               tangent2 * (1.0 / 13.0 -
                                                           tangent2 * (1.0 / 15.0 -
                                                                       tangent2 / 17.0))))))));
  } else {
    const T sine = sqrt(sine2);
    factor = 2.0 * atan2(sine, w) / sine;
  }
  return factor * v;
}

inline Eigen::Matrix3d SkewMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d skew;
  skew << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return skew;
}

// Exp(d + e) = Exp(LeftJacobian(d) e) Exp(d) to first order in e.
//   J = I + (1 - cos a) / a^2 [d]x + (a - sin a) / a^3 [d]x^2,   a = |d|
inline Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& d) {
  const double angle2 = d.squaredNorm();
  double first, second;
  if (angle2 < 0.01) {  // the closed form of the second term cancels
    first = 0.5 - angle2 * (1.0 / 24.0 - angle2 * (1.0 / 720.0 - angle2 / 40320.0));
    second = 1.0 / 6.0 - angle2 * (1.0 / 120.0 - angle2 * (1.0 / 5040.0 - angle2 / 362880.0));
  } else {
    const double angle = std::sqrt(angle2);
    first = (1.0 - std::cos(angle)) / angle2;
    second = (angle - std::sin(angle)) / (angle2 * angle);
  }
  const Eigen::Matrix3d skew = SkewMatrix(d);
  return Eigen::Matrix3d::Identity() + first * skew + second * skew * skew;
}

// Inverse of LeftJacobian, for |d| < 2 pi.
//   J^-1 = I - 1/2 [d]x + (1 - a/2 cot(a/2)) / a^2 [d]x^2,   a = |d|
inline Eigen::Matrix3d LeftJacobianInverse(const Eigen::Vector3d& d) {
  const double angle2 = d.squaredNorm();
  double second;
  if (angle2 < 0.01) {
    second =
        1.0 / 12.0 + angle2 * (1.0 / 720.0 + angle2 * (1.0 / 30240.0 + angle2 / 1209600.0));
  } else {
    const double half = 0.5 * std::sqrt(angle2);
    second = (1.0 - half * std::cos(half) / std::sin(half)) / angle2;
  }
  const Eigen::Matrix3d skew = SkewMatrix(d);
  return Eigen::Matrix3d::Identity() - 0.5 * skew + second * skew * skew;
}

}  // namespace plumbline
