#include "factors/imu/gyroscope_factor.h"

#include <ceres/sized_cost_function.h>

#include <type_traits>

#include "factors/imu/imu_motion.h"

namespace plumbline {
namespace {

class GyroscopeFactor final
    : public ceres::
          SizedCostFunction<3, 4, 4, 4, 4, kImuBlockSize, kImuBiasSize, kImuBiasSize> {
 public:
  GyroscopeFactor(const ImuMeasurement& measurement,
                  const ImuPose& stated,
                  double knot_interval_s)
      : measurement_(measurement), stated_(stated), knot_interval_s_(knot_interval_s) {}

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const auto blocks = [](auto* const* all) {
      return ReadingBlocks<std::decay_t<decltype(all[0])>>{
          {all[0], all[1], all[2], all[3]}, all[4], all[5], all[6]};
    };
    const ReadingBlocks<const double*> values = blocks(parameters);
    const StepsOfSpline steps = StepsBetween(values.rotations);
    BodyReading reading;
    for (const double u : measurement_.u) {
      const RotationMotion motion = EvaluateRotationMotion(
          steps.data(), u + values.imu[kImuDelayAt] / knot_interval_s_, knot_interval_s_);
      reading.value += 0.5 * motion.rate;
      reading.by_steps += 0.5 * motion.rate_by_steps;
      reading.by_u += 0.5 * motion.rate_by_u;
    }
    EvaluateReading(measurement_,
                    stated_,
                    knot_interval_s_,
                    kImuGyroscopeScaleAt,
                    reading,
                    steps,
                    values,
                    residuals,
                    jacobians == nullptr ? ReadingBlocks<double*>() : blocks(jacobians));
    return true;
  }

 private:
  ImuMeasurement measurement_;
  ImuPose stated_;
  double knot_interval_s_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreateGyroscopeFactor(const ImuMeasurement& measurement,
                                                           const ImuPose& stated,
                                                           double knot_interval_s) {
  return std::make_unique<GyroscopeFactor>(measurement, stated, knot_interval_s);
}

}  // namespace plumbline
