#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/recording/messages.h"
#include "core/sensor/odometry.h"
#include "core/sensor/odometry_repair.h"
#include "core/sensor/rig.h"

namespace plumbline {

// OdometryCollector takes a recording's odometry message by message.
class OdometryCollector {
 public:
  // rig: has to outlive the collector.
  explicit OdometryCollector(const Rig& rig) : rig_(rig) {}

  void Add(const OdometryMessage& message);
  // Why it says nothing of the motion: no orientation, or a pose that never changes; empty
  // where it may.
  std::string Fault() const;
  // Returns the odometry, once its messages contradict themselves no more (odometry_repair.h);
  // nullptr where it has a fault. Appends what was mended to sentences.
  std::shared_ptr<const Odometry> Finish(std::vector<std::string>* sentences) const;
  bool empty() const { return poses_.empty(); }

 private:
  const Rig& rig_;
  std::vector<CountedPose> poses_;
  int num_without_orientation_ = 0;  // whose quaternion is none, such as all zero
};

}  // namespace plumbline
