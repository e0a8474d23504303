#include "factors/imu/accelerometer_factor.h"

#include <ceres/sized_cost_function.h>

#include <array>
#include <type_traits>

#include "factors/imu/imu_motion.h"
#include "factors/spline/so3.h"

namespace plumbline {
namespace {

// The force in the body and its derivatives: those of a reading, by the position control
// points, by gravity in the world and by the IMU's place in the body.
struct SpecificForce {
  SpecificForce() { by_positions.fill(Eigen::Matrix3d::Zero()); }

  BodyReading reading;
  std::array<Eigen::Matrix3d, kSplineOrder> by_positions;
  Eigen::Matrix3d by_gravity = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d by_lever = Eigen::Matrix3d::Zero();
};

class AccelerometerFactor final : public ceres::SizedCostFunction<3,
                                                                  4,
                                                                  4,
                                                                  4,
                                                                  4,
                                                                  3,
                                                                  3,
                                                                  3,
                                                                  3,
                                                                  kImuBlockSize,
                                                                  kImuBiasSize,
                                                                  kImuBiasSize> {
 public:
  AccelerometerFactor(const ImuMeasurement& measurement,
                      const ImuPose& stated,
                      double gravity_m_s2,
                      double knot_interval_s)
      : measurement_(measurement),
        stated_(stated),
        gravity_m_s2_(gravity_m_s2),
        knot_interval_s_(knot_interval_s) {}

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    const auto blocks = [](auto* const* all) {
      return ReadingBlocks<std::decay_t<decltype(all[0])>>{
          {all[0], all[1], all[2], all[3]}, all[8], all[9], all[10]};
    };
    const ReadingBlocks<const double*> values = blocks(parameters);
    const StepsOfSpline steps = StepsBetween(values.rotations);
    const Eigen::Vector3d lean(values.imu[kImuLeanAt], values.imu[kImuLeanAt + 1], 0.0);
    const Eigen::Vector3d gravity = Exp(lean) * Eigen::Vector3d(0.0, 0.0, -gravity_m_s2_);
    const SpecificForce force =
        MeanForce(steps, parameters + kSplineOrder, values.imu, gravity);
    const ReadingBlocks<double*> of_reading =
        jacobians == nullptr ? ReadingBlocks<double*>() : blocks(jacobians);
    const Eigen::Matrix3d by_value = EvaluateReading(measurement_,
                                                     stated_,
                                                     knot_interval_s_,
                                                     kImuAccelerometerScaleAt,
                                                     force.reading,
                                                     steps,
                                                     values,
                                                     residuals,
                                                     of_reading);
    if (jacobians == nullptr) return true;
    for (size_t j = 0; j < kSplineOrder; ++j) {
      double* const jacobian = jacobians[kSplineOrder + j];
      if (jacobian == nullptr) continue;
      Eigen::Map<RowMajor>{jacobian} = by_value * force.by_positions[j];
    }
    if (of_reading.imu != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, kImuBlockSize, Eigen::RowMajor>> by_imu(
          of_reading.imu);
      by_imu.middleCols<3>(kImuShiftAt) = by_value * force.by_lever;
      const Eigen::Matrix3d by_lean =
          force.by_gravity * -SkewMatrix(gravity) * LeftJacobian(lean);
      by_imu.middleCols<2>(kImuLeanAt) = by_value * by_lean.leftCols<2>();
    }
    return true;
  }

 private:
  // What the accelerometer's place feels in the body, the mean over the instants of the
  // measurement, and its derivatives. positions: the position control points; gravity: in the
  // world.
  SpecificForce MeanForce(const StepsOfSpline& steps,
                          const double* const* positions,
                          const double* imu,
                          const Eigen::Vector3d& gravity) const {
    using ConstVector = Eigen::Map<const Eigen::Vector3d>;
    const Eigen::Vector3d lever = stated_.position_body + ConstVector(imu + kImuShiftAt);
    const Eigen::Matrix3d across_lever = SkewMatrix(lever);
    const double per_s2 = 1.0 / (knot_interval_s_ * knot_interval_s_);
    const Eigen::Vector3d jerk =  // by u
        per_s2 * (ConstVector(positions[3]) - ConstVector(positions[0]) +
                  3.0 * (ConstVector(positions[1]) - ConstVector(positions[2])));
    SpecificForce force;
    BodyReading& reading = force.reading;
    for (const double stated_u : measurement_.u) {
      const double u = stated_u + imu[kImuDelayAt] / knot_interval_s_;
      const RotationMotion motion = EvaluateRotationMotion(steps.data(), u, knot_interval_s_);
      const Eigen::Matrix3d body_from_world =
          motion.body_from_first * steps[0].body_from_world;
      const std::array<double, kSplineOrder> weights = {
          1.0 - u, 3.0 * u - 2.0, 1.0 - 3.0 * u, u};
      Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
      for (size_t j = 0; j < kSplineOrder; ++j) {
        acceleration += per_s2 * weights[j] * ConstVector(positions[j]);
        force.by_positions[j] += 0.5 * per_s2 * weights[j] * body_from_world;
      }
      const Eigen::Vector3d of_body = body_from_world * (acceleration - gravity);
      const Eigen::Matrix3d by_turn = SkewMatrix(of_body);
      const Eigen::Vector3d speed = motion.rate.cross(lever);  // of the IMU about the body
      const Eigen::Matrix3d by_rate =
          -SkewMatrix(speed) - SkewMatrix(motion.rate) * across_lever;
      reading.value +=
          0.5 * (of_body + motion.acceleration.cross(lever) + motion.rate.cross(speed));
      reading.by_steps +=
          0.5 * (by_turn * motion.turn_by_steps + by_rate * motion.rate_by_steps -
                 across_lever * motion.acceleration_by_steps);
      reading.by_first += 0.5 * by_turn * body_from_world;
      reading.by_u +=
          0.5 * (knot_interval_s_ * of_body.cross(motion.rate) + body_from_world * jerk +
                 by_rate * motion.rate_by_u - across_lever * motion.acceleration_by_u);
      force.by_gravity -= 0.5 * body_from_world;
      force.by_lever += 0.5 * (SkewMatrix(motion.acceleration) +
                               SkewMatrix(motion.rate) * SkewMatrix(motion.rate));
    }
    return force;
  }

  ImuMeasurement measurement_;
  ImuPose stated_;
  double gravity_m_s2_;
  double knot_interval_s_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreateAccelerometerFactor(
    const ImuMeasurement& measurement,
    const ImuPose& stated,
    double gravity_m_s2,
    double knot_interval_s) {
  return std::make_unique<AccelerometerFactor>(
      measurement, stated, gravity_m_s2, knot_interval_s);
}

}  // namespace plumbline
