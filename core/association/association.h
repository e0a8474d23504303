#pragma once

#include <Eigen/Core>
#include <cmath>
#include <deque>
#include <vector>

#include "core/association/line_deviation.h"
#include "core/geometry/matrix_types.h"
#include "core/geometry/scan_plane_motion.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/options/mapper_options.h"
#include "core/sensor/rig.h"
#include "core/surface/landmark.h"
#include "core/surface/landmark_view.h"
#include "core/surface/patch_extent.h"

namespace plumbline {

// Whether an observation of a scan may lie on the landmark by the gap rule: with loop closure
// switched off, a landmark that was unseen for more than max_gap_scans scans is not taken up
// again.
bool IsWithinGap(const Landmark& landmark, int scan_index, const LoopClosureOptions& options);

// Whether an observation may lie on the landmark while the rig is tracked, where a pose may
// rest on few segments: a landmark that was unseen for longer than the gap is taken up again
// only if its segments agreed with it.
bool MayBeTakenUp(const Landmark& landmark, int scan_index, const LoopClosureOptions& options);

// The landmarks with segments that observations of a single scan may lie on by the gap rule.
// The scan reaches a few of hundreds: of the others nothing but the distance is computed.
struct LandmarksWithinGap {
  const std::deque<Landmark>& landmarks;
  int scan_index;
  const LoopClosureOptions& options;
};

// Views of the landmarks with segments that observations of a scan may lie on by the gap rule;
// they serve many scans where loop closure is on.
std::vector<LandmarkView> ViewsWithinGap(const std::deque<Landmark>& landmarks,
                                         int scan_index,
                                         const LoopClosureOptions& options);

// A ball that planes have to have been seen in to matter.
class Reach {
 public:
  // farthest_m: the distance of the farthest thing seen from the point; the ball adds a margin
  // for options.max_gap_m and the motion during a scan.
  Reach(const Eigen::Vector3d& p_world, double farthest_m, const AssociationOptions& options);

  // Whether the extent comes into the ball; centre and radius of a sphere around the extent
  // rule most others out.
  bool Takes(const PatchExtent& extent, const Eigen::Vector3d& centre, double radius_m) const;
  bool Takes(const LandmarkView& view) const {
    return Takes(view.landmark->extent, view.centre_world, view.radius_m);
  }

 private:
  Eigen::Vector3d p_world_;
  double reach_m_;
};

// A slab around a scan plane that holds the beams of its scan line, the scanner's motion
// included.
class ScanSlab {
 public:
  // farthest_m: the longest beam. The slab is wider by the margin on both sides.
  ScanSlab(const ScanMotion& motion, double farthest_m, double margin_m);

  // Whether the solid around what was seen of a surface comes into the slab.
  bool Touches(const LandmarkView& view) const {
    const double across = normal_.dot(view.centre_world - origin_);
    return std::abs(across) <= view.ReachAlong(normal_) + half_width_m_;
  }

 private:
  Eigen::Vector3d origin_;
  Eigen::Vector3d normal_;
  double half_width_m_;
};

// The ball that holds all planes which HypothesesOf may find for the observations of one scan:
// observations[first] and those of its scan that follow. body_world: position of the rig.
// pose_covariance: at least that of any pose in the scan.
Reach ReachOfScan(const Rig& rig,
                  const std::deque<Observation>& observations,
                  size_t first,
                  const Eigen::Vector3d& body_world,
                  const Matrix6d& pose_covariance,
                  const AssociationOptions& options);

// Selects the landmarks whose extents come into the ball.
std::vector<LandmarkView> ViewsWithin(const Reach& reach,
                                      const std::vector<LandmarkView>& views);
std::vector<LandmarkView> ViewsWithin(const Reach& reach, const LandmarksWithinGap& landmarks);

// The covariance that the unevenness of real surfaces adds to a LineDeviation of this length.
Eigen::Matrix2d FlatnessCovariance(double length_m, double flatness_m);

// Whether the observation runs along a known floor, ceiling or slope that its scan plane hardly
// cuts: within max_distance_m of it at both ends. Such a trace tells nothing, and looks like a
// wall's.
bool Grazes(const Observation& observation,
            const ObservationPoses& poses,
            const std::deque<Landmark>& landmarks,
            double max_distance_m);

// A landmark that an observation may lie on.
struct Hypothesis {
  int id = -1;
  LineDeviation deviation;
  Eigen::Matrix2d noise =
      Eigen::Matrix2d::Identity();  // of the deviation, the pose's left out
  double distance2 = 0.0;           // squared Mahalanobis distance
  double score = 0.0;               // -2 ln of the deviation's density, up to a constant
};

// The hypotheses of an observation among the views, by the tests of FindLandmark.
std::vector<Hypothesis> HypothesesOf(const Observation& observation,
                                     const ObservationPoses& poses,
                                     const Matrix6d& pose_covariance,
                                     const std::vector<LandmarkView>& views,
                                     const AssociationOptions& options);

// The landmark whose plane an observation most probably lies on, or -1. A landmark must face
// the scanner, have been seen near the segment, and agree with it in distance and direction:
// the squared Mahalanobis distance of the two stays below the quantile of the significance,
// where the covariance takes in the segment's noise, the pose's (pose_covariance: world-frame
// rotation and position of the body), the plane's and the surface's unevenness.
int FindLandmark(const Observation& observation,
                 const ObservationPoses& poses,
                 const Matrix6d& pose_covariance,
                 const std::vector<LandmarkView>& views,
                 const AssociationOptions& options);

}  // namespace plumbline
