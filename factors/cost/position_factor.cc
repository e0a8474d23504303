#include "factors/cost/position_factor.h"

#include <ceres/autodiff_cost_function.h>

#include "factors/spline/spline.h"

namespace plumbline {
namespace {

struct PositionFunctor {
  Eigen::Vector3d position;
  double u;
  double whitening;

  template <typename T>
  bool operator()(const T* p0, const T* p1, const T* p2, const T* p3, T* residuals) const {
    const T* const p[4] = {p0, p1, p2, p3};
    EvaluatePosition(p, u, residuals);
    for (int axis = 0; axis < 3; ++axis) {
      residuals[axis] = whitening * (residuals[axis] - position[axis]);
    }
    return true;
  }
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreatePositionFactor(const Eigen::Vector3d& position,
                                                          double u,
                                                          double stddev) {
  return std::make_unique<ceres::AutoDiffCostFunction<PositionFunctor, 3, 3, 3, 3, 3>>(
      new PositionFunctor{position, u, 1.0 / stddev});
}

}  // namespace plumbline
