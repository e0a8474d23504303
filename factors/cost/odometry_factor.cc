#include "factors/cost/odometry_factor.h"

#include <ceres/autodiff_cost_function.h>

#include <Eigen/Geometry>

#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

struct OdometryFunctor {
  OdometryMeasurement measurement;

  template <typename T>
  bool operator()(const T* q0,
                  const T* q1,
                  const T* q2,
                  const T* q3,
                  const T* p0,
                  const T* p1,
                  const T* p2,
                  const T* p3,
                  T* residuals) const {
    using Quaternion = Eigen::Quaternion<T>;
    using Vector3 = Eigen::Matrix<T, 3, 1>;
    const T* const q[4] = {q0, q1, q2, q3};
    const T* const p[4] = {p0, p1, p2, p3};
    Quaternion begin;
    Quaternion end;
    Vector3 p_begin;
    Vector3 p_end;
    EvaluateRotation(q, 0.0, begin.coeffs().data());
    EvaluateRotation(q, 1.0, end.coeffs().data());
    EvaluatePosition(p, 0.0, p_begin.data());
    EvaluatePosition(p, 1.0, p_end.data());
    const Vector3 translation = begin.conjugate() * Vector3(p_end - p_begin);
    const Quaternion begin_from_end = begin.conjugate() * end;
    const Vector3 turn = Log(begin_from_end);
    for (int axis = 0; axis < 2; ++axis) {
      residuals[axis] =
          (translation[axis] - measurement.translation[axis]) / measurement.translation_stddev;
    }
    residuals[2] = (turn.z() - measurement.turn) / measurement.turn_stddev;
    return true;
  }
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreateOdometryFactor(
    const OdometryMeasurement& measurement) {
  return std::make_unique<
      ceres::AutoDiffCostFunction<OdometryFunctor, 3, 4, 4, 4, 4, 3, 3, 3, 3>>(
      new OdometryFunctor{measurement});
}

}  // namespace plumbline
