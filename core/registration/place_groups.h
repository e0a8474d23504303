#pragma once

#include <vector>

#include "core/geometry/planar_pose.h"
#include "core/registration/pose_graph.h"
#include "core/registration/visit.h"
#include "core/registration/visit_matching.h"

namespace plumbline {

// Closures that agree with each other: a stretch of the way lies where an earlier one does.
using PlaceGroup = std::vector<PoseGraphEdge>;

// Sorts closures into groups that agree pairwise (pairwise consistency: Mangelson et al. 2018,
// "Pairwise Consistent Measurement Set Maximization"): from a first visit to a second one by
// the first closure, the motion and back by the second closure leads to where it began, as far
// as the drift of the motion allows. A group is kept where it goes on for min_way_m of both
// stretches, and no other one that contradicts it finds a quarter as many visits of the same
// stretch again: places that look alike contradict each other. motion: from each visit to the
// next, with its information.
std::vector<PlaceGroup> ConsistentGroups(const std::vector<PoseGraphEdge>& closures,
                                         const std::vector<PoseGraphEdge>& motion,
                                         const std::vector<Visit>& visits,
                                         double min_way_m);

}  // namespace plumbline
