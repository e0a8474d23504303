#include "factors/cost/pose_factor.h"

#include <ceres/cost_function.h>

#include "factors/manifold/manifolds.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;

class PoseCost final : public ceres::CostFunction {
 public:
  PoseCost(const PoseMeasurement& measurement, double u) : measurement_(measurement), u_(u) {
    *mutable_parameter_block_sizes() = {4, 4, 4, 4, 3, 3, 3, 3};
    set_num_residuals(6);
  }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    SplinePoseJacobian spline;
    const SplinePose pose = EvaluatePose(
        parameters, parameters + kSplineOrder, u_, jacobians == nullptr ? nullptr : &spline);
    Eigen::Matrix<double, 6, 1> error;
    error << Log(pose.world_from_body * measurement_.world_from_body.conjugate()),
        pose.position - measurement_.position;
    Eigen::Map<Eigen::Matrix<double, 6, 1>>{residuals} =
        measurement_.root * error + measurement_.offset;
    if (jacobians == nullptr) return true;
    const Matrix63 by_rotation =
        measurement_.root.leftCols<3>() * LeftJacobianInverse(error.head<3>());
    for (int j = 0; j < kSplineOrder; ++j) {
      if (double* const jacobian = jacobians[j]) {
        const Matrix63 by_control = by_rotation * spline.rotation_wrt_control[j];
        Eigen::Map<Eigen::Matrix<double, 6, 4, Eigen::RowMajor>>{jacobian} =
            by_control * RotationMinusJacobian(parameters[j]);
      }
      if (double* const jacobian = jacobians[kSplineOrder + j]) {
        Eigen::Map<Eigen::Matrix<double, 6, 3, Eigen::RowMajor>>{jacobian} =
            measurement_.root.rightCols<3>() * spline.position_weights[j];
      }
    }
    return true;
  }

 private:
  PoseMeasurement measurement_;
  double u_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreatePoseFactor(const PoseMeasurement& measurement,
                                                      double u) {
  return std::make_unique<PoseCost>(measurement, u);
}

}  // namespace plumbline
