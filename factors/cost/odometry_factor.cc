#include "factors/cost/odometry_factor.h"

#include <ceres/dynamic_autodiff_cost_function.h>
#include <glog/logging.h>

#include <Eigen/Geometry>

#include "factors/spline/so3.h"

namespace plumbline {
namespace {

struct OdometryFunctor {
  OdometryMeasurement measurement;
  SplineNode begin;
  SplineNode end;
  int num_control_points;

  template <typename T>
  bool operator()(T const* const* parameters, T* residuals) const {
    using Quaternion = Eigen::Quaternion<T>;
    using Vector3 = Eigen::Matrix<T, 3, 1>;
    T const* const* positions = parameters + num_control_points;
    Quaternion q_begin;
    Quaternion q_end;
    Vector3 p_begin;
    Vector3 p_end;
    EvaluateRotation(parameters + begin.first, begin.u, q_begin.coeffs().data());
    EvaluateRotation(parameters + end.first, end.u, q_end.coeffs().data());
    EvaluatePosition(positions + begin.first, begin.u, p_begin.data());
    EvaluatePosition(positions + end.first, end.u, p_end.data());
    const Vector3 translation = q_begin.conjugate() * Vector3(p_end - p_begin);
    const Quaternion begin_from_end = q_begin.conjugate() * q_end;
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
    const OdometryMeasurement& measurement,
    const SplineNode& begin,
    const SplineNode& end,
    int num_control_points) {
  for (const SplineNode& node : {begin, end}) {
    CHECK(node.first >= 0 && node.first + kSplineOrder <= num_control_points) << node.first;
  }
  auto cost = std::make_unique<ceres::DynamicAutoDiffCostFunction<OdometryFunctor, 8>>(
      new OdometryFunctor{measurement, begin, end, num_control_points});
  for (int i = 0; i < num_control_points; ++i) cost->AddParameterBlock(4);
  for (int i = 0; i < num_control_points; ++i) cost->AddParameterBlock(3);
  cost->SetNumResiduals(3);
  return cost;
}

}  // namespace plumbline
