#pragma once

#include <cstdint>
#include <vector>

#include "core/trajectory/trajectory.h"

namespace plumbline {

// The largest accelerations of a trajectory in one second, those of its spline at the knots.
struct SecondOfMotion {
  double acceleration_m_s2 = 0.0;
  double angular_acceleration_rad_s2 = 0.0;
  double speed_m_s = 0.0;
};

// One element for each second of the recording that the trajectory covers.
std::vector<SecondOfMotion> MotionOverTime(const Trajectory& trajectory, int64_t start_ns);

// Seconds in which the rig would have accelerated as no other second shows it, and as hardly
// any rig does: a pose that jumped.
std::vector<bool> FindJumps(const std::vector<SecondOfMotion>& motion);

}  // namespace plumbline
