#pragma once

#include <deque>
#include <set>
#include <vector>

#include "core/association/association.h"
#include "core/geometry/matrix_types.h"
#include "core/map/landmark.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/options/mapper_options.h"

namespace plumbline {

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
};

// The types that a single segment leaves to its plane (paper, section 4.4).
struct TypeEvidence {
  bool can_be_horizontal = false;
  bool can_be_vertical = false;
};

// Judges the type of a segment's plane by the segment's direction in the world, which is known
// to direction_sigma_rad.
TypeEvidence JudgeType(const Observation& observation,
                       const Eigen::Quaterniond& world_from_scanner,
                       double direction_sigma_rad,
                       double significance);

// Collects segments without a landmark into tentative planes, and gives up those that are to
// become landmarks: seen in several scans, direction known well, type beyond doubt. That a
// plane is a wall takes several scans, too.
class TentativePlanes {
 public:
  TentativePlanes(bool planar, const MapperOptions& options);

  // Gives the observation to the tentative planes that it agrees with, or starts a new one.
  void Offer(const Observation& observation,
             int observation_index,
             const ObservationPoses& poses,
             const Matrix6d& pose_covariance);

  // Removes and returns the tentative planes that are to become landmarks. min_scans: see
  // PlaneOptions. needs_age: whether small planes have to have their age, since something
  // moves.
  std::vector<TentativePlane> TakeReady(int min_scans, bool needs_age);

  // Drops tentative planes that nothing has confirmed for a while.
  void DropStale(int64_t now_ns);

 private:
  bool Matches(const TentativePlane& plane,
               const Observation& observation,
               const LineDeviation& deviation,
               const ObservationPoses& poses,
               const Matrix6d& pose_covariance) const;
  TypeEvidence EvidenceOf(const Observation& observation,
                          const ObservationPoses& poses,
                          const Matrix6d& pose_covariance) const;
  Eigen::Matrix2d FlatnessOf(const Observation& observation) const;
  // Starts a plane through the observation, of the type that the evidence leaves.
  void Start(const Observation& observation,
             int observation_index,
             const ObservationPoses& poses,
             const TypeEvidence& evidence);
  // Whether the plane is large, or was seen for long enough not to be somebody who walks.
  bool HasAge(const TentativePlane& plane) const;
  bool IsReady(const TentativePlane& plane, int min_scans, bool needs_age) const;

  bool planar_;
  const MapperOptions& options_;
  std::deque<TentativePlane> planes_;
};

}  // namespace plumbline
