#include "factors/cost/motion_factor.h"

#include <ceres/autodiff_cost_function.h>

#include <Eigen/Core>

#include "factors/spline/so3.h"

namespace plumbline {
namespace {

template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

// Rotation vector from q0 to q1, in the world.
template <typename T>
Vector3<T> RotationDifference(const T* q0, const T* q1) {
  using ConstQuaternion = Eigen::Map<const Eigen::Quaternion<T>>;
  return Log(ConstQuaternion(q1) * ConstQuaternion(q0).conjugate());
}

struct PositionAccelerationFunctor {
  Eigen::Vector3d whitening;
  Eigen::Vector3d velocity_persistence;
  Eigen::Vector3d of_mean;  // m, that the mean velocity adds

  template <typename T>
  bool operator()(const T* p0, const T* p1, const T* p2, T* residuals) const {
    for (int axis = 0; axis < 3; ++axis) {
      residuals[axis] = whitening[axis] *
                        ((p2[axis] - p1[axis]) -
                         velocity_persistence[axis] * (p1[axis] - p0[axis]) - of_mean[axis]);
    }
    return true;
  }
};

struct RotationAccelerationFunctor {
  Eigen::Vector3d whitening;

  template <typename T>
  bool operator()(const T* q0, const T* q1, const T* q2, T* residuals) const {
    Eigen::Map<Vector3<T>>{residuals} =
        whitening.cast<T>().asDiagonal() *
        (RotationDifference(q1, q2) - RotationDifference(q0, q1));
    return true;
  }
};

// Innovation: the part of the second of two accelerations that does not follow from the first.
template <typename AccelerationFunctor>
struct InnovationFunctor {
  AccelerationFunctor acceleration;
  Eigen::Vector3d persistence;

  template <typename T>
  bool operator()(const T* x0, const T* x1, const T* x2, const T* x3, T* residuals) const {
    Vector3<T> before;
    acceleration(x0, x1, x2, before.data());
    acceleration(x1, x2, x3, residuals);
    Eigen::Map<Vector3<T>>{residuals} -= persistence.cast<T>().cwiseProduct(before);
    return true;
  }
};

struct PositionVelocityFunctor {
  double whitening;

  template <typename T>
  bool operator()(const T* p0, const T* p1, T* residuals) const {
    for (int axis = 0; axis < 3; ++axis) residuals[axis] = whitening * (p1[axis] - p0[axis]);
    return true;
  }
};

struct RotationVelocityFunctor {
  double whitening;

  template <typename T>
  bool operator()(const T* q0, const T* q1, T* residuals) const {
    Eigen::Map<Vector3<T>>{residuals} = RotationDifference(q0, q1) * T(whitening);
    return true;
  }
};

template <int... kBlockSizes, typename Functor>
std::unique_ptr<ceres::CostFunction> MakeFactor(Functor functor) {
  return std::make_unique<ceres::AutoDiffCostFunction<Functor, 3, kBlockSizes...>>(
      new Functor(functor));
}

// Returns the whitening of second differences.
Eigen::Vector3d Whitening(const Eigen::Vector3d& stddev, double knot_interval_s) {
  return (stddev * knot_interval_s * knot_interval_s).cwiseInverse();
}

PositionAccelerationFunctor MakeAcceleration(const Eigen::Vector3d& stddev,
                                             const MotionPersistence& persistence,
                                             double knot_interval_s) {
  const Eigen::Vector3d lost = Eigen::Vector3d::Ones() - persistence.velocity;
  return {Whitening(stddev, knot_interval_s),
          persistence.velocity,
          knot_interval_s * lost.cwiseProduct(persistence.mean_velocity)};
}

}  // namespace

std::unique_ptr<ceres::CostFunction> CreatePositionAccelerationFactor(
    const Eigen::Vector3d& stddev,
    const MotionPersistence& persistence,
    double knot_interval_s) {
  return MakeFactor<3, 3, 3>(MakeAcceleration(stddev, persistence, knot_interval_s));
}

std::unique_ptr<ceres::CostFunction> CreateRotationAccelerationFactor(
    const Eigen::Vector3d& stddev, double knot_interval_s) {
  return MakeFactor<4, 4, 4>(RotationAccelerationFunctor{Whitening(stddev, knot_interval_s)});
}

std::unique_ptr<ceres::CostFunction> CreatePositionInnovationFactor(
    const Eigen::Vector3d& stddev,
    const MotionPersistence& persistence,
    double knot_interval_s) {
  return MakeFactor<3, 3, 3, 3>(InnovationFunctor<PositionAccelerationFunctor>{
      MakeAcceleration(stddev, persistence, knot_interval_s), persistence.acceleration});
}

std::unique_ptr<ceres::CostFunction> CreateRotationInnovationFactor(
    const Eigen::Vector3d& stddev, double persistence, double knot_interval_s) {
  return MakeFactor<4, 4, 4, 4>(InnovationFunctor<RotationAccelerationFunctor>{
      {Whitening(stddev, knot_interval_s)}, Eigen::Vector3d::Constant(persistence)});
}

std::unique_ptr<ceres::CostFunction> CreatePositionVelocityFactor(double stddev,
                                                                  double knot_interval_s) {
  return MakeFactor<3, 3>(PositionVelocityFunctor{1.0 / (stddev * knot_interval_s)});
}

std::unique_ptr<ceres::CostFunction> CreateRotationVelocityFactor(double stddev,
                                                                  double knot_interval_s) {
  return MakeFactor<4, 4>(RotationVelocityFunctor{1.0 / (stddev * knot_interval_s)});
}

}  // namespace plumbline
