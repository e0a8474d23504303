#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/geometry/planar_pose.h"

namespace plumbline {

// Measured pose of one node in the frame of another one.
struct PoseGraphEdge {
  size_t from = 0;
  size_t to = 0;
  PlanarPose from_from_to;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();  // of x, y (m) and heading (rad)
  bool may_be_wrong = false;  // it counts less, the farther the poses are from it
};

// Moves planar poses (world_from_node) to where the edges have them, by least squares, with
// Cauchy's loss on edges that may be wrong; the first one stays. Headings and edges count
// whole turns alike. Poses stay as they are where the solver fails, which it logs.
void SolvePoseGraph(const std::vector<PoseGraphEdge>& edges, std::vector<PlanarPose>* poses);

// Returns the squared deviation of the poses from an edge, over its variances; whole turns do
// not count.
double SquaredDeviation(const PoseGraphEdge& edge, const std::vector<PlanarPose>& poses);

}  // namespace plumbline
