#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/sensor/odometry.h"

namespace plumbline {

// A pose as a message states it, and what the same message says of its velocity.
struct CountedPose {
  OdometrySample sample;
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  // m/s, ahead and to the left; 0: unsaid
};

// Returns the samples in the order of time, without what their own messages contradict:
//   - A pose that is sent again while the rig moves on, so that its velocity would jump to 0
//     and back, is left out.
//   - Where the pose goes forward in nearly all steps whose velocity is backward, the wheels
//     count their way without its sign: these steps are turned round.
// Appends a sentence for the user about each.
std::vector<OdometrySample> RepairOdometry(std::vector<CountedPose> poses,
                                           std::vector<std::string>* sentences);

}  // namespace plumbline
