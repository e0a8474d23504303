#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/judging/evidence.h"
#include "core/map/map_state.h"
#include "core/sensor/rig.h"

namespace plumbline {

// The largest accelerations of a trajectory in one second, those of its spline at the knots. A
// rig may turn and walk as it likes; what it is carried by tells how it tilts and rises.
struct SecondOfMotion {
  static constexpr size_t kNumKinds = 4;
  enum Kind : size_t { kHorizontal, kVertical, kYaw, kTilt };

  std::array<double, kNumKinds> accelerations = {};  // m/s^2, m/s^2, rad/s^2, rad/s^2
};

// One element for each second of the recording that the trajectory covers. Where nothing is
// mapped, and just before and after, there are no accelerations.
std::vector<SecondOfMotion> MotionOverTime(const MapState& state, int64_t start_ns);

// Points of segments without a plane, of all points of segments, by intervals of kSlipTime.
SharesOverTime SupportOverTime(const MapState& state, int64_t start_ns);

// Seconds in which, for an instant, far fewer segments than just before and after have a plane
// while the rig seems to move harder than it usually does: a few poses that are wrong between
// right ones.
std::vector<bool> FindGlitches(const std::vector<SecondOfMotion>& motion,
                               const SharesOverTime& support);

// Seconds in which the rig would have accelerated as hardly any other second shows it, by any
// kind of motion: a pose that jumped, or a jolt, as at a door sill.
// Where beams pass through what were surfaces at other times in the same second, less does:
// the pose slipped from one surface to the next one, a step of a stair.
std::vector<bool> FindJumps(const std::vector<SecondOfMotion>& motion,
                            const SharesOverTime& passages);

// Seconds in which the rig would have accelerated, harder than it usually does, in a direction
// that no wide surface shows: a pose that slipped along a corridor with somebody who walks
// there, or from one tread to the next one.
std::vector<bool> FindUnsupportedJumps(const Rig& rig,
                                       const MapState& state,
                                       const std::vector<SecondOfMotion>& motion,
                                       int64_t start_ns);

}  // namespace plumbline
