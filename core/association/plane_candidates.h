#pragma once

#include <deque>
#include <set>
#include <vector>

#include "core/association/association.h"
#include "core/association/tentative_plane.h"
#include "core/association/undecided_planes.h"
#include "core/geometry/matrix_types.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/options/mapper_options.h"
#include "core/surface/landmark.h"

namespace plumbline {

// The types that a single segment leaves to its plane (paper, section 4.4).
struct TypeEvidence {
  bool can_be_horizontal = false;
  bool can_be_vertical = false;
  // The trace of a scan plane that is nearly level, which mostly meets walls, or one steeper
  // than any ramp. Other sloping traces may as well lie on a ramp or a roof.
  bool is_wall = false;

  // Whether the segment may lie on a tentative plane of this kind.
  bool Allows(const HorizontalPlane&) const { return can_be_horizontal; }
  template <typename Upright>
  bool Allows(const Upright&) const {
    return can_be_vertical;
  }
};

// Judges the type of a segment's plane by the segment's direction in the world, which is known
// to direction_sigma_rad.
TypeEvidence JudgeType(const Observation& observation,
                       const Eigen::Quaterniond& world_from_scanner,
                       double direction_sigma_rad,
                       double significance);

// Collects segments without a landmark into tentative planes, and gives up those that are to
// become landmarks: seen in several scans, direction known well, type beyond doubt. That a
// plane is a wall takes several scans, too. Planes of any direction come from UndecidedPlanes.
class TentativePlanes {
 public:
  // range_noise_m: of the scanners. knows_turns: an IMU reads how the rig turns, so that what
  // its turns sweep counts as what its way does.
  TentativePlanes(bool planar,
                  const MapperOptions& options,
                  double range_noise_m,
                  bool knows_turns = false);

  // Gives the observation to the tentative planes that it agrees with, or starts a new one.
  // founds_wall: it is known to lie on a wall.
  void Offer(const Observation& observation,
             int observation_index,
             const ObservationPoses& poses,
             const Matrix6d& pose_covariance,
             bool founds_wall = false);

  // Removes and returns the tentative planes that are to become landmarks. min_scans: see
  // PlaneOptions. needs_age: whether small planes have to have their age, since something
  // moves. min_scanners: that have to show a wall.
  std::vector<TentativePlane> TakeReady(int min_scans, bool needs_age, int min_scanners = 1);

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
             const TypeEvidence& evidence,
             const MeasuredLine& line);
  bool IsReady(const TentativePlane& plane,
               int min_scans,
               bool needs_age,
               int min_scanners) const;

  bool planar_;
  const MapperOptions& options_;
  double range_noise_m_;
  bool knows_turns_;
  std::deque<TentativePlane> planes_;
  UndecidedPlanes undecided_;
};

}  // namespace plumbline
