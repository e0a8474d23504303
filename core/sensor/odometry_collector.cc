#include "core/sensor/odometry_collector.h"

#include <algorithm>

#include "core/util/time.h"

namespace plumbline {

void OdometryCollector::Add(const OdometryMessage& message) {
  double norm2 = 0.0;
  for (const double value : message.orientation) norm2 += value * value;
  if (!(norm2 > 0.5)) ++num_without_orientation_;
  const double offset_s = rig_.odometry_time_offset_s.value_or(0.0);
  poses_.push_back({{message.stamp_ns + NanosecondsFromSeconds(offset_s),
                     {message.position[0], message.position[1]},
                     message.Yaw()},
                    {message.linear_velocity[0], message.linear_velocity[1]}});
}

std::string OdometryCollector::Fault() const {
  if (num_without_orientation_ > 0) {
    return std::to_string(num_without_orientation_) + " of " + std::to_string(poses_.size()) +
           " messages have no orientation (their quaternion is not of length 1)";
  }
  const bool is_frozen =
      poses_.size() > 1 &&
      std::all_of(poses_.begin(), poses_.end(), [this](const CountedPose& pose) {
        return pose.sample.position == poses_.front().sample.position &&
               pose.sample.heading == poses_.front().sample.heading;
      });
  // The scans show it if a rig stands all the time.
  return is_frozen ? "its pose never changes" : "";
}

std::shared_ptr<const Odometry> OdometryCollector::Finish(
    std::vector<std::string>* sentences) const {
  if (poses_.empty() || !Fault().empty()) return nullptr;
  return std::make_shared<const Odometry>(RepairOdometry(poses_, sentences));
}

}  // namespace plumbline
