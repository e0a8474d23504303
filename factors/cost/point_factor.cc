#include "factors/cost/point_factor.h"

#include <ceres/autodiff_cost_function.h>

#include "factors/spline/spline.h"

namespace plumbline {
namespace {

template <typename Plane>
struct PointFunctor {
  PointMeasurement measurement;
  Plane plane;

  template <typename T>
  bool operator()(const T* q0,
                  const T* q1,
                  const T* q2,
                  const T* q3,
                  const T* p0,
                  const T* p1,
                  const T* p2,
                  const T* p3,
                  const T* body_from_scanner_q,
                  const T* body_from_scanner_t,
                  const T* plane_params,
                  T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const T* const q[4] = {q0, q1, q2, q3};
    const T* const p[4] = {p0, p1, p2, p3};
    Eigen::Quaternion<T> world_from_body;
    Vector position, normal;
    T distance;
    EvaluateRotation(q, measurement.u, world_from_body.coeffs().data());
    EvaluatePosition(p, measurement.u, position.data());

    const Vector point_scanner(
        T(measurement.point_scanner.x()), T(measurement.point_scanner.y()), T(0.0));
    const Vector point_body =
        Eigen::Map<const Eigen::Quaternion<T>>(body_from_scanner_q) * point_scanner +
        Eigen::Map<const Vector>(body_from_scanner_t);
    const Vector point_world = world_from_body * point_body + position;
    EvaluateNear(plane, plane_params, point_world.data(), normal.data(), &distance);
    *residual =
        measurement.whitening * (normal.dot(point_world) - distance) + T(measurement.offset);
    return true;
  }
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreatePointFactor(const PointMeasurement& measurement,
                                                       PlaneModel model,
                                                       const PlaneChart& chart) {
  return VisitPlaneModel(
      model, chart, [&](const auto& plane) -> std::unique_ptr<ceres::CostFunction> {
        using Functor = PointFunctor<std::decay_t<decltype(plane)>>;
        constexpr int kPlaneSize = std::decay_t<decltype(plane)>::kSize;
        return std::make_unique<
            ceres::AutoDiffCostFunction<Functor, 1, 4, 4, 4, 4, 3, 3, 3, 3, 4, 3, kPlaneSize>>(
            new Functor{measurement, plane});
      });
}

}  // namespace plumbline
