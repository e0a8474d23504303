#pragma once

#include <cstdint>

#include "factors/cost/pose_factor.h"

namespace plumbline {

// What points that lie on no plane say of the rig's pose at an instant.
struct PoseConstraint {
  int64_t time_ns = 0;
  PoseMeasurement measurement;
};

}  // namespace plumbline
