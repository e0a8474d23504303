#include "core/sensor/odometry_collector.h"

#include <algorithm>

#include "core/util/time.h"

namespace plumbline {

void OdometryCollector::Add(const OdometryMessage& message) {
  double norm2 = 0.0;
  for (const double value : message.orientation) norm2 += value * value;
  if (!(norm2 > 0.5)) ++num_without_orientation_;
  samples_.push_back({message.stamp_ns + NanosecondsFromSeconds(rig_.odometry_time_offset_s),
                      {message.position[0], message.position[1]},
                      message.Yaw()});
}

std::string OdometryCollector::Fault() const {
  if (num_without_orientation_ > 0) {
    return std::to_string(num_without_orientation_) + " of " +
           std::to_string(samples_.size()) +
           " messages have no orientation (their quaternion is not of length 1)";
  }
  const bool is_frozen =
      samples_.size() > 1 &&
      std::all_of(samples_.begin(), samples_.end(), [this](const OdometrySample& sample) {
        return sample.position == samples_.front().position &&
               sample.heading == samples_.front().heading;
      });
  // The scans show it if a rig stands all the time.
  return is_frozen ? "its pose never changes" : "";
}

}  // namespace plumbline
