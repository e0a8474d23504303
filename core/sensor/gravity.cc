#include "core/sensor/gravity.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "core/util/time.h"

namespace plumbline {

std::optional<UpDirection> FindUp(const ImuReadings& readings,
                                  const Imu& imu,
                                  int64_t time_ns,
                                  double acceleration_density_m_s2) {
  const double step_s = 2.0 * readings.period_s();
  // What does not depend on the time: how the IMU sits, and what a reading at rest is off.
  const double sensor_rad = std::hypot(
      imu.rotation_rad, imu.accelerometer.scale, imu.accelerometer.bias / kStandardGravity);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Quaterniond first_from_now = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();  // of the last readings, and their instant
  double rate_s = 0.0;
  double turned_rad = 0.0;
  UpDirection best;
  best.stddev_rad = std::numeric_limits<double>::infinity();
  for (double begin_s = 0.0; step_s > 0.0; begin_s += step_s) {
    const int64_t begin_ns = time_ns + NanosecondsFromSeconds(begin_s);
    const ImuMean mean = readings.MeanOf(begin_ns, begin_ns + NanosecondsFromSeconds(step_s));
    if (mean.num_samples == 0) break;
    if (begin_s == 0.0) rate = mean.angular_rate;
    const Eigen::Vector3d turn =
        0.5 * (rate + mean.angular_rate) * (begin_s + mean.time_s - rate_s);
    rate = mean.angular_rate;
    rate_s = begin_s + mean.time_s;
    first_from_now =
        (first_from_now * Eigen::AngleAxisd(turn.norm(), turn.normalized())).normalized();
    sum += first_from_now * mean.specific_force;
    turned_rad += turn.norm();
    const double time_s = begin_s + step_s;
    // The mean is turned by half of what the gyroscope is off in the end.
    const double by_gyroscope =
        0.5 * (imu.gyroscope.bias * time_s + imu.gyroscope.scale * turned_rad);
    const double by_motion = acceleration_density_m_s2 / std::sqrt(time_s) / kStandardGravity;
    const double stddev_rad = std::hypot(sensor_rad, by_gyroscope, by_motion);
    if (stddev_rad < best.stddev_rad) {
      best = {imu.body_from_imu.rotation * sum.normalized(), stddev_rad};
    }
    if (by_gyroscope > best.stddev_rad) break;
  }
  if (!std::isfinite(best.stddev_rad)) return std::nullopt;
  return best;
}

}  // namespace plumbline
