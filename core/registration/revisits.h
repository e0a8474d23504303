#pragma once

#include <vector>

#include "core/geometry/planar_pose.h"
#include "core/registration/pose_graph.h"
#include "core/registration/visit.h"
#include "core/sensor/odometry.h"

namespace plumbline {

// Time since a place was left from which it counts as seen again, s.
inline constexpr double kMinAbsence = 20.0;

// Poses of visits once the places that the rig came back to are recognised.
struct PlacedVisits {
  std::vector<PlanarPose> world_from_visit;
  std::vector<PoseGraphEdge> closures;  // between visits of one place, earlier to later
  int num_contradicted = 0;             // closures left out: the others contradict them
};

// Finds where the rig was before, visit by visit in the order of time, and spreads what that
// says of the drift over the way between: a pose graph of the visits, with the motion from one
// to the next as the trajectory has it. Then looks for places farther from where they are
// believed to be than any drift, anywhere: these count where a stretch of the way agrees on
// them (ConsistentGroups). wheels, if any: where they contradict the motion, it may have
// slipped, and takes up what the places say first. Works on the threads of the caller's
// tbb::task_arena; the result does not depend on their number.
PlacedVisits PlaceVisits(const std::vector<Visit>& visits, const Odometry* wheels = nullptr);

// Whether the visits lie where their own trajectory has them, as far as the closures can tell.
bool Hold(const std::vector<PoseGraphEdge>& closures, const std::vector<Visit>& visits);

}  // namespace plumbline
