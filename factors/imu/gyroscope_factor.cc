#include "factors/imu/gyroscope_factor.h"

#include <ceres/autodiff_cost_function.h>

#include "factors/imu/imu_motion.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

struct GyroscopeFunctor {
  ImuMeasurement measurement;
  ImuPose stated;
  double knot_interval_s;

  template <typename T>
  bool operator()(const T* q0,
                  const T* q1,
                  const T* q2,
                  const T* q3,
                  const T* imu,
                  const T* bias,
                  const T* next_bias,
                  T* residuals) const {
    const T* const q[4] = {q0, q1, q2, q3};
    const Steps<T> steps = StepsOf(q);
    Eigen::Matrix<T, 3, 1> rate_body = Eigen::Matrix<T, 3, 1>::Zero();
    for (const double u : measurement.u) {
      const T delayed = u + imu[kImuDelayAt] / knot_interval_s;
      rate_body += MotionOf<true>(steps, delayed, knot_interval_s).rate_body * T(0.5);
    }
    const Eigen::Matrix<T, 3, 1> rate = BodyFromImu(stated, imu).conjugate() * rate_body;
    WhitenReadings(measurement, rate, imu + kImuGyroscopeScaleAt, bias, next_bias, residuals);
    return true;
  }
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreateGyroscopeFactor(const ImuMeasurement& measurement,
                                                           const ImuPose& stated,
                                                           double knot_interval_s) {
  return std::make_unique<ceres::AutoDiffCostFunction<GyroscopeFunctor,
                                                      3,
                                                      4,
                                                      4,
                                                      4,
                                                      4,
                                                      kImuBlockSize,
                                                      kImuBiasSize,
                                                      kImuBiasSize>>(
      new GyroscopeFunctor{measurement, stated, knot_interval_s});
}

}  // namespace plumbline
