#include "core/trajectory/motion_noise.h"

#include <cmath>

namespace plumbline {

MotionNoise MotionNoise::Of(const TrajectoryOptions& options) {
  return {options.acceleration_stddev_m_s2,
          options.acceleration_stddev_m_s2,
          options.angular_acceleration_stddev_deg_s2 * M_PI / 180.0};
}

}  // namespace plumbline
