#include "core/trajectory/motion_prior.h"

#include <algorithm>

namespace plumbline {

MotionPrior::MotionPrior(const TrajectoryOptions& options) : usual_(MotionNoise::Of(options)) {
  usual_.vertical_m_s2 =
      std::min(usual_.vertical_m_s2, options.vertical_acceleration_stddev_m_s2);
  bridging_ = usual_;
  bridging_.horizontal_m_s2 =
      std::min(bridging_.horizontal_m_s2, options.bridging_acceleration_stddev_m_s2);
}

MotionNoise MotionPrior::At(int first) const {
  return bridged_.count(first) > 0 ? bridging_ : usual_;
}

void MotionPrior::Bridge(int first, int end) {
  for (int i = first; i < end; ++i) bridged_.insert(i);
}

}  // namespace plumbline
