#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <set>
#include <vector>

#include "core/association/bend_test.h"
#include "core/association/plane_through_lines.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/options/mapper_options.h"
#include "core/surface/landmark.h"

namespace plumbline {

// The rig's motion after which one scanner has swept enough of a plane to tell its kind.
inline constexpr double kRevealingMotion = 0.3;  // m

// A tentative plane: segments without a landmark agree on it, and it is not trusted yet.
struct TentativePlane {
  Landmark landmark;              // covariance given the poses
  std::vector<int> observations;  // indices
  std::set<int> scans;
  std::set<int> scanners;
  std::set<int> clear_scans;  // with a segment that can only lie on a plane of this type
  Eigen::Vector3d first_position = Eigen::Vector3d::Zero();  // of the body, world
  Eigen::Vector3d last_position = Eigen::Vector3d::Zero();
  int64_t first_time_ns = 0;
  int64_t last_time_ns = 0;
  PlaneThroughLines lines;  // its traces, on a plane of any direction
  MeasuredLine first_line;  // the first of them
  double swept_m = 0.0;     // farthest that another one lies beside it
  BendTest bend;            // of a wall

  // Takes in the extent, counts and times of an observation on any plane; its landmark and
  // clear_scans stay.
  void Count(const Observation& observation,
             int observation_index,
             const ObservationPoses& poses,
             const MeasuredLine& line);
  // Whether it is large, or was seen for long enough not to be somebody who walks.
  bool HasAge(const PlaneOptions& options) const;
  // The way that the rig went while the plane was seen, m.
  double Motion() const { return (last_position - first_position).norm(); }
};

}  // namespace plumbline
