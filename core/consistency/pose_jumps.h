#pragma once

#include <cstdint>
#include <vector>

#include "core/consistency/evidence.h"
#include "core/map/map_state.h"
#include "core/trajectory/trajectory.h"

namespace plumbline {

// The largest accelerations of a trajectory in one second, those of its spline at the knots.
struct SecondOfMotion {
  double acceleration_m_s2 = 0.0;
  double angular_acceleration_rad_s2 = 0.0;
  double speed_m_s = 0.0;
  double vertical_acceleration_m_s2 = 0.0;
};

// One element for each second of the recording that the trajectory covers.
std::vector<SecondOfMotion> MotionOverTime(const Trajectory& trajectory, int64_t start_ns);

// Points of segments without a plane, of all points of segments, by intervals of kSupportStep.
inline constexpr double kSupportStep = 0.125;  // s
SharesOverTime SupportOverTime(const MapState& state, int64_t start_ns);

// Seconds in which, for an instant, far fewer segments than just before and after have a plane
// while the rig seems to move harder than it usually does: a few poses that are wrong between
// right ones.
std::vector<bool> FindGlitches(const std::vector<SecondOfMotion>& motion,
                               const SharesOverTime& support);

// Seconds in which the rig would have accelerated as no other second shows it, and as hardly
// any rig does: a pose that jumped.
// Where beams pass through what were surfaces at other times in the same second, less does:
// the pose slipped from one surface to the next one, a step of a stair.
std::vector<bool> FindJumps(const std::vector<SecondOfMotion>& motion,
                            const SharesOverTime& passages);

// Seconds in which, for an interval of kSupportStep at least, no floor or ceiling shows the
// height of the rig: narrow horizontal planes, as treads, or nothing.
std::vector<bool> HeightHangsOnTreads(const MapState& state, int64_t start_ns);

// Seconds in which the height jumps while it hangs on treads: one was taken for the next.
std::vector<bool> FindHeightJumps(const std::vector<SecondOfMotion>& motion,
                                  const std::vector<bool>& hangs_on_treads);

}  // namespace plumbline
