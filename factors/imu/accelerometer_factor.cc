#include "factors/imu/accelerometer_factor.h"

#include <ceres/autodiff_cost_function.h>

#include "factors/imu/imu_motion.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

struct AccelerometerFunctor {
  ImuMeasurement measurement;
  ImuPose stated;
  double gravity_m_s2;
  double knot_interval_s;

  template <typename T>
  bool operator()(const T* q0,
                  const T* q1,
                  const T* q2,
                  const T* q3,
                  const T* p0,
                  const T* p1,
                  const T* p2,
                  const T* p3,
                  const T* imu,
                  const T* bias,
                  const T* next_bias,
                  T* residuals) const {
    using Vector3 = Eigen::Matrix<T, 3, 1>;
    const T* const q[4] = {q0, q1, q2, q3};
    const T* const p[4] = {p0, p1, p2, p3};
    const Vector3 lean(imu[kImuLeanAt], imu[kImuLeanAt + 1], T(0.0));
    const Vector3 gravity = Exp(lean) * Vector3(T(0.0), T(0.0), T(-gravity_m_s2));
    const Vector3 shift(imu[kImuShiftAt], imu[kImuShiftAt + 1], imu[kImuShiftAt + 2]);
    const Vector3 lever = stated.position_body.template cast<T>() + shift;
    const Steps<T> steps = StepsOf(q);
    const Eigen::Map<const Eigen::Quaternion<T>> world_from_first(q0);
    Vector3 force_body = Vector3::Zero();
    for (const double u : measurement.u) {
      const T delayed = u + imu[kImuDelayAt] / knot_interval_s;
      const SplineMotion<T> motion = MotionOf(steps, delayed, knot_interval_s);
      const Vector3 acceleration = EvaluateAcceleration(p, delayed, knot_interval_s);
      const Vector3 of_first = world_from_first.conjugate() * Vector3(acceleration - gravity);
      const Vector3 of_body = motion.first_from_body.conjugate() * of_first;
      const Vector3 of_lever = motion.angular_acceleration_body.cross(lever) +
                               motion.rate_body.cross(Vector3(motion.rate_body.cross(lever)));
      force_body += (of_body + of_lever) * T(0.5);
    }
    const Vector3 force = BodyFromImu(stated, imu).conjugate() * force_body;
    WhitenReadings(
        measurement, force, imu + kImuAccelerometerScaleAt, bias, next_bias, residuals);
    return true;
  }
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreateAccelerometerFactor(
    const ImuMeasurement& measurement,
    const ImuPose& stated,
    double gravity_m_s2,
    double knot_interval_s) {
  return std::make_unique<ceres::AutoDiffCostFunction<AccelerometerFunctor,
                                                      3,
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
                                                      kImuBiasSize>>(
      new AccelerometerFunctor{measurement, stated, gravity_m_s2, knot_interval_s});
}

}  // namespace plumbline
