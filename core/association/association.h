#pragma once

#include <Eigen/Core>
#include <cmath>
#include <deque>
#include <vector>

#include "core/association/line_deviation.h"
#include "core/geometry/matrix_types.h"
#include "core/geometry/scan_plane_motion.h"
#include "core/map/landmark.h"
#include "core/map/landmark_view.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/map/patch_extent.h"
#include "core/options/mapper_options.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Which landmarks an observation may belong to, by the gap rule: with loop closure switched
// off, a landmark that was unseen for more than max_gap_scans scans is not taken up again.
bool IsWithinGap(const Landmark& landmark, int scan_index, const LoopClosureOptions& options);

// Likewise on the way, where a pose may rest on few segments: one that was unseen for longer
// is taken up again only if its segments agreed with it.
bool MayBeTakenUp(const Landmark& landmark, int scan_index, const LoopClosureOptions& options);

// The landmarks with segments that observations of a scan may belong to. For a single scan,
// which reaches a few of hundreds: no more is computed of the others than how far they are.
struct LandmarksWithinGap {
  const std::deque<Landmark>& landmarks;
  int scan_index;
  const LoopClosureOptions& options;
};

// The same as candidates: for many scans.
std::vector<LandmarkView> ViewsWithinGap(const std::deque<Landmark>& landmarks,
                                         int scan_index,
                                         const LoopClosureOptions& options);

// A ball that planes have to have been seen in to matter.
class Reach {
 public:
  // farthest_m: of what is looked at from the point; the ball adds a margin for
  // options.max_gap_m and the motion during a scan.
  Reach(const Eigen::Vector3d& p_world, double farthest_m, const AssociationOptions& options);

  // Whether the extent comes into the ball; centre and radius of a sphere around the extent
  // tell most that do not.
  bool Takes(const PatchExtent& extent, const Eigen::Vector3d& centre, double radius_m) const;
  bool Takes(const LandmarkView& candidate) const {
    return Takes(candidate.landmark->extent, candidate.centre_world, candidate.radius_m);
  }

 private:
  Eigen::Vector3d p_world_;
  double reach_m_;
};

// Where the beams of a scan line pass, the scanner's motion included: a slab around its plane.
class ScanSlab {
 public:
  // Of beams up to this long; it is wider by a margin on both sides.
  ScanSlab(const ScanMotion& motion, double farthest_m, double margin_m);

  // Whether the rectangle around what was seen of a plane comes into it.
  bool Touches(const LandmarkView& candidate) const {
    const double across = normal_.dot(candidate.centre_world - origin_);
    const double half =
        std::abs(normal_.dot(candidate.half_u)) + std::abs(normal_.dot(candidate.half_v));
    return std::abs(across) <= half + half_width_m_;
  }

 private:
  Eigen::Vector3d origin_;
  Eigen::Vector3d normal_;
  double half_width_m_;
};

// Takes all that HypothesesOf may find for the observations of one scan: that of
// observations[first] and those that follow it; body_world: where the rig was then.
// pose_covariance: at least that of any pose in the scan.
Reach ReachOfScan(const Rig& rig,
                  const std::deque<Observation>& observations,
                  size_t first,
                  const Eigen::Vector3d& body_world,
                  const Matrix6d& pose_covariance,
                  const AssociationOptions& options);

// Those that it takes.
std::vector<LandmarkView> ViewsWithin(const Reach& reach,
                                      const std::vector<LandmarkView>& candidates);
std::vector<LandmarkView> ViewsWithin(const Reach& reach, const LandmarksWithinGap& landmarks);

// Covariance that the unevenness of real surfaces adds to a LineDeviation of this length.
Eigen::Matrix2d FlatnessCovariance(double length_m, double flatness_m);

// A landmark that an observation may lie on.
struct Hypothesis {
  int id = -1;
  LineDeviation deviation;
  Eigen::Matrix2d noise =
      Eigen::Matrix2d::Identity();  // of the deviation, the pose's left out
  double distance2 = 0.0;           // squared Mahalanobis distance
  double score = 0.0;               // -2 ln of the deviation's density, up to a constant
};

// Those of the candidates that the observation may lie on; see FindLandmark.
std::vector<Hypothesis> HypothesesOf(const Observation& observation,
                                     const ObservationPoses& poses,
                                     const Matrix6d& pose_covariance,
                                     const std::vector<LandmarkView>& candidates,
                                     const AssociationOptions& options);

// The landmark whose plane an observation most probably lies on, or -1. A candidate must face
// the scanner, have been seen near the segment, and agree with it in distance and direction:
// the squared Mahalanobis distance of the two stays below the quantile of the significance,
// where the covariance takes in the segment's noise, the pose's (pose_covariance: world-frame
// rotation and position of the body), the plane's and the surface's unevenness.
int FindLandmark(const Observation& observation,
                 const ObservationPoses& poses,
                 const Matrix6d& pose_covariance,
                 const std::vector<LandmarkView>& candidates,
                 const AssociationOptions& options);

}  // namespace plumbline
