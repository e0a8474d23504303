#include "factors/imu/imu_motion.h"

#include "factors/manifold/manifolds.h"
#include "factors/spline/so3.h"

namespace plumbline {
namespace {

template <int kColumns>
using RowMajorRows = Eigen::Matrix<double, 3, kColumns, Eigen::RowMajor>;

}  // namespace

StepsOfSpline StepsBetween(const std::array<const double*, 4>& rotations) {
  return {MakeRotationStep(rotations[0], rotations[1]),
          MakeRotationStep(rotations[1], rotations[2]),
          MakeRotationStep(rotations[2], rotations[3])};
}

Eigen::Matrix3d EvaluateReading(const ImuMeasurement& measurement,
                                const ImuPose& stated,
                                double knot_interval_s,
                                int scale_at,
                                const BodyReading& reading,
                                const StepsOfSpline& steps,
                                const ReadingBlocks<const double*>& values,
                                double* residuals,
                                const ReadingBlocks<double*>& jacobians) {
  using ConstVector = Eigen::Map<const Eigen::Vector3d>;
  const ConstVector turn(values.imu + kImuTurnAt);
  const ConstVector scale(values.imu + scale_at);
  const double share = measurement.bias_share;
  const Eigen::Vector3d weight = measurement.stddev.cwiseInverse();
  const Eigen::Matrix3d imu_from_body =
      (Exp(turn) * stated.body_from_imu).conjugate().toRotationMatrix();
  const Eigen::Vector3d value_imu = imu_from_body * reading.value;
  const Eigen::Matrix3d by_value =
      (Eigen::Vector3d::Ones() + scale).cwiseProduct(weight).asDiagonal() * imu_from_body;
  Eigen::Map<Eigen::Vector3d>{residuals} = weight.cwiseProduct(
      value_imu + scale.cwiseProduct(value_imu) + (1.0 - share) * ConstVector(values.bias) +
      share * ConstVector(values.next_bias) - measurement.mean);
  // A control point turns the steps before and behind it.
  std::array<Eigen::Matrix3d, 4> by_rotations;
  by_rotations[0] = by_value * reading.by_first;
  for (size_t j = 0; j < 3; ++j) {
    const Eigen::Matrix3d by_turn =
        by_value * reading.by_steps.middleCols<3>(3 * static_cast<Eigen::Index>(j)) *
        LeftJacobianInverse(steps[j].vector) * steps[j].body_from_world;
    by_rotations[j] -= by_turn;
    by_rotations[j + 1] = by_turn;
  }
  for (size_t j = 0; j < 4; ++j) {
    if (jacobians.rotations[j] == nullptr) continue;
    Eigen::Map<RowMajorRows<4>>{jacobians.rotations[j]} =
        by_rotations[j] * RotationMinusJacobian(values.rotations[j]);
  }
  if (jacobians.imu != nullptr) {
    Eigen::Map<RowMajorRows<kImuBlockSize>> by_imu(jacobians.imu);
    by_imu.setZero();
    by_imu.middleCols<3>(kImuTurnAt) =
        by_value * SkewMatrix(reading.value) * LeftJacobian(turn);
    by_imu.col(kImuDelayAt) = by_value * reading.by_u / knot_interval_s;
    by_imu.middleCols<3>(scale_at).diagonal() = weight.cwiseProduct(value_imu);
  }
  const auto take_bias = [&](double of_block, double* jacobian) {
    if (jacobian == nullptr) return;
    Eigen::Map<RowMajorRows<kImuBiasSize>>{jacobian} =
        Eigen::Matrix3d(of_block * weight.asDiagonal());
  };
  take_bias(1.0 - share, jacobians.bias);
  take_bias(share, jacobians.next_bias);
  return by_value;
}

}  // namespace plumbline
