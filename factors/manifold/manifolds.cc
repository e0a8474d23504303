#include "factors/manifold/manifolds.h"

#include <ceres/manifold.h>

#include <Eigen/Geometry>
#include <cmath>

#include "factors/spline/so3.h"

namespace plumbline {
namespace {

using ConstQuaternion = Eigen::Map<const Eigen::Quaterniond>;
using Quaternion = Eigen::Map<Eigen::Quaterniond>;
template <int kRows, int kCols>
using RowMajorMap = Eigen::Map<
    Eigen::Matrix<double, kRows, kCols, kCols == 1 ? Eigen::ColMajor : Eigen::RowMajor>>;

class RotationManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 4; }
  int TangentSize() const override { return 3; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Eigen::Map<const Eigen::Vector3d> tangent(delta);
    Quaternion{x_plus_delta} = (Exp(tangent) * ConstQuaternion(x)).normalized();
    return true;
  }
  bool PlusJacobian(const double* x, double* jacobian) const override {
    RowMajorMap<4, 3>{jacobian} = RotationPlusJacobian(x);
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Eigen::Vector3d>{y_minus_x} =
        Log(ConstQuaternion(y) * ConstQuaternion(x).conjugate());
    return true;
  }
  bool MinusJacobian(const double* x, double* jacobian) const override {
    RowMajorMap<3, 4>{jacobian} = RotationMinusJacobian(x);
    return true;
  }
};

class YawManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 4; }
  int TangentSize() const override { return 1; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Eigen::Vector3d tangent(0.0, 0.0, delta[0]);
    Quaternion{x_plus_delta} = (Exp(tangent) * ConstQuaternion(x)).normalized();
    return true;
  }
  bool PlusJacobian(const double* x, double* jacobian) const override {
    RowMajorMap<4, 1>{jacobian} = RotationPlusJacobian(x).col(2);
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    *y_minus_x = YawDifference(y, x);
    return true;
  }
  bool MinusJacobian(const double* x, double* jacobian) const override {
    RowMajorMap<1, 4>{jacobian} = RotationMinusJacobian(x).row(2);
    return true;
  }
};

class VerticalPlaneManifold final : public ceres::Manifold {
 public:
  explicit VerticalPlaneManifold(const Eigen::Vector2d& centre) : centre_(centre) {}

  int AmbientSize() const override { return 2; }
  int TangentSize() const override { return 2; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const double bend = Bend(x[0], delta[0]);
    x_plus_delta[1] = x[1] + delta[1] + bend;
    x_plus_delta[0] = x[0] + delta[0];
    return true;
  }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    RowMajorMap<2, 2>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    const double turn = y[0] - x[0];
    y_minus_x[1] = y[1] - x[1] - Bend(x[0], turn);
    y_minus_x[0] = turn;
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    RowMajorMap<2, 2>(jacobian).setIdentity();
    return true;
  }

 private:
  // (n(a + turn) - n(a) - n'(a) turn) . centre
  double Bend(double a, double turn) const {
    const Eigen::Vector2d normal(std::cos(a), std::sin(a));
    const Eigen::Vector2d turned(std::cos(a + turn), std::sin(a + turn));
    const Eigen::Vector2d derivative(-normal.y(), normal.x());
    return (turned - normal - turn * derivative).dot(centre_);
  }

  Eigen::Vector2d centre_;
};

}  // namespace

std::unique_ptr<ceres::Manifold> CreateRotationManifold() {
  return std::make_unique<RotationManifold>();
}

std::unique_ptr<ceres::Manifold> CreateYawManifold() {
  return std::make_unique<YawManifold>();
}

std::unique_ptr<ceres::Manifold> CreateVerticalPlaneManifold(const Eigen::Vector2d& centre) {
  return std::make_unique<VerticalPlaneManifold>(centre);
}

Eigen::Matrix<double, 4, 3> RotationPlusJacobian(const double* q) {
  const ConstQuaternion rotation(q);
  Eigen::Matrix<double, 4, 3> jacobian;
  jacobian.topRows<3>() =
      0.5 * (rotation.w() * Eigen::Matrix3d::Identity() - SkewMatrix(rotation.vec()));
  jacobian.bottomRows<1>() = -0.5 * rotation.vec().transpose();
  return jacobian;
}

Eigen::Matrix<double, 3, 4> RotationMinusJacobian(const double* q) {
  // The columns of the plus Jacobian are orthogonal and 1/2 long.
  const double x = 2.0 * q[0], y = 2.0 * q[1], z = 2.0 * q[2], w = 2.0 * q[3];
  Eigen::Matrix<double, 3, 4> jacobian;
  jacobian << w, -z, y, -x,  //
      z, w, -x, -y,          //
      -y, x, w, -z;
  return jacobian;
}

double YawDifference(const double* q, const double* q0) {
  Eigen::Quaterniond difference = ConstQuaternion(q) * ConstQuaternion(q0).conjugate();
  if (difference.w() < 0.0) difference.coeffs() *= -1.0;
  return 2.0 * std::atan2(difference.z(), difference.w());
}

}  // namespace plumbline
