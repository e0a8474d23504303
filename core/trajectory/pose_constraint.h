#pragma once

#include <cstdint>

#include "factors/cost/pose_factor.h"

namespace plumbline {

// Constraint on the rig's pose at an instant by points that lie on no plane.
struct PoseConstraint {
  int64_t time_ns = 0;
  PoseMeasurement measurement;
};

}  // namespace plumbline
