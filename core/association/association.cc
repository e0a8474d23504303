#include "core/association/association.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/association/surface_levels.h"
#include "core/geometry/matrix_types.h"
#include "core/surface/landmark_view.h"
#include "core/surface/patch_extent.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

// The coarse test compares one distance with bounds on its variance; what it neglects may add
// to the distance.
constexpr double kCoarseMargin = 4.0;
// A reach allows this much for the motion during a scan and for cells that reach beyond what
// was seen.
constexpr double kReachMargin = 1.0;  // m

// The centroid on the straight line between the ends, where they were measured.
Eigen::Vector3d CentroidWorld(const Observation& observation,
                              const Eigen::Vector3d& start_world,
                              const Eigen::Vector3d& end_world) {
  const Eigen::Vector2d along = observation.end() - observation.start();
  const double length2 = along.squaredNorm();
  if (!(length2 > 0.0)) return start_world;
  const double share = along.dot(observation.centroid() - observation.start()) / length2;
  return start_world + share * (end_world - start_world);
}

// An upper bound of the part of a deviation's variance that comes from the pose; distance2:
// the squared distance from the body.
double MaxVariance(const Matrix6d& pose_covariance, double distance2) {
  return pose_covariance.bottomRightCorner<3, 3>().trace() +
         pose_covariance.topLeftCorner<3, 3>().trace() * distance2;
}

double MinCuttingSine(const LandmarkView& view) {
  return view.traits.passes_for_wall ? kMinCuttingSineOfSlopes : kMinCuttingSine;
}

}  // namespace

bool Grazes(const Observation& observation,
            const ObservationPoses& poses,
            const std::deque<Landmark>& landmarks,
            double max_distance_m) {
  const Eigen::Vector3d scan_normal =
      poses.world_from_scanner.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d start =
      poses.motion.ToWorld(observation.start(), observation.start_time_ns());
  const Eigen::Vector3d end =
      poses.motion.ToWorld(observation.end(), observation.end_time_ns());
  return std::any_of(landmarks.begin(), landmarks.end(), [&](const Landmark& landmark) {
    if (landmark.num_segments == 0 || !TraitsOf(landmark).passes_for_wall) return false;
    return scan_normal.cross(landmark.Normal()).squaredNorm() <
               kMinCuttingSineOfSlopes * kMinCuttingSineOfSlopes &&
           std::abs(landmark.SignedDistance(start)) < max_distance_m &&
           std::abs(landmark.SignedDistance(end)) < max_distance_m;
  });
}

bool IsWithinGap(const Landmark& landmark, int scan_index, const LoopClosureOptions& options) {
  return options.enabled || (scan_index - landmark.last_scan <= options.max_gap_scans &&
                             landmark.first_scan - scan_index <= options.max_gap_scans);
}

bool MayBeTakenUp(const Landmark& landmark,
                  int scan_index,
                  const LoopClosureOptions& options) {
  return IsWithinGap(landmark, scan_index, options) &&
         (scan_index - landmark.last_scan <= options.max_gap_scans ||
          landmark.AgreesWithin(kMaxMeanChi2 * kExpectedDeviation));
}

std::vector<LandmarkView> ViewsWithinGap(const std::deque<Landmark>& landmarks,
                                         int scan_index,
                                         const LoopClosureOptions& options) {
  std::vector<LandmarkView> views;
  views.reserve(landmarks.size());
  for (const Landmark& landmark : landmarks) {
    if (landmark.num_segments > 0 && IsWithinGap(landmark, scan_index, options)) {
      views.emplace_back(landmark);
    }
  }
  return views;
}

Reach::Reach(const Eigen::Vector3d& p_world,
             double farthest_m,
             const AssociationOptions& options)
    : p_world_(p_world),
      // A gap counts in whole cells in both directions: its diagonal is the longest.
      reach_m_(farthest_m + 1.5 * options.max_gap_m + kReachMargin) {}

bool Reach::Takes(const PatchExtent& extent,
                  const Eigen::Vector3d& centre,
                  double radius_m) const {
  const double sphere_m = reach_m_ + radius_m;
  return (p_world_ - centre).squaredNorm() <= sphere_m * sphere_m &&
         extent.IsWithinReach(p_world_, reach_m_);
}

ScanSlab::ScanSlab(const ScanMotion& motion, double farthest_m, double margin_m)
    : origin_(motion.nodes()[1].col(2)), half_width_m_(margin_m) {
  const auto normal_of = [](const ScanPlacement& placement) -> Eigen::Vector3d {
    return placement.col(0).cross(placement.col(1));
  };
  normal_ = normal_of(motion.nodes()[1]);
  double motion_m = 0.0;
  for (const ScanPlacement& placement : motion.nodes()) {
    motion_m = std::max(motion_m,
                        std::abs(normal_.dot(placement.col(2) - origin_)) +
                            (normal_of(placement) - normal_).norm() * farthest_m);
  }
  half_width_m_ += motion_m;
}

Reach ReachOfScan(const Rig& rig,
                  const std::deque<Observation>& observations,
                  size_t first,
                  const Eigen::Vector3d& body_world,
                  const Matrix6d& pose_covariance,
                  const AssociationOptions& options) {
  double farthest = 0.0;
  for (size_t i = first; i < observations.size(); ++i) {
    const Observation& observation = observations[i];
    if (observation.scan_index != observations[first].scan_index) break;
    const double lever_arm = rig.scanners[static_cast<size_t>(observation.scanner_index)]
                                 .BodyFromScanner(observation.middle_time_ns())
                                 .translation.norm();
    farthest = std::max(
        farthest, lever_arm + std::max(observation.start().norm(), observation.end().norm()));
  }
  // Distance from its plane that the pose error alone allows an observation, m.
  const double off = std::sqrt(kCoarseMargin * TwoDegreesQuantile(options.significance) * 2.0 *
                               MaxVariance(pose_covariance, farthest * farthest));
  return {body_world, farthest + off, options};
}

std::vector<LandmarkView> ViewsWithin(const Reach& reach,
                                      const std::vector<LandmarkView>& views) {
  std::vector<LandmarkView> within;
  within.reserve(views.size());
  for (const LandmarkView& view : views) {
    if (reach.Takes(view)) within.push_back(view);
  }
  return within;
}

std::vector<LandmarkView> ViewsWithin(const Reach& reach,
                                      const LandmarksWithinGap& landmarks) {
  std::vector<LandmarkView> within;
  for (const Landmark& landmark : landmarks.landmarks) {
    if (landmark.num_segments == 0 ||
        !MayBeTakenUp(landmark, landmarks.scan_index, landmarks.options)) {
      continue;
    }
    const PatchExtent& extent = landmark.extent;
    if (reach.Takes(extent, extent.Centre(), extent.radius_m())) within.emplace_back(landmark);
  }
  return within;
}

Eigen::Matrix2d FlatnessCovariance(double length_m, double flatness_m) {
  // A bump somewhere along the segment: its offset, and the slope between its two halves.
  const double slope = flatness_m / std::max(0.5 * length_m, flatness_m);
  return Eigen::Vector2d(flatness_m * flatness_m, slope * slope).asDiagonal();
}

namespace {

// Calls visit(hypothesis) for the landmarks that the observation may lie on.
template <typename Visit>
void VisitHypotheses(const Observation& observation,
                     const ObservationPoses& poses,
                     const Matrix6d& pose_covariance,
                     const std::vector<LandmarkView>& views,
                     const AssociationOptions& options,
                     const Visit& visit) {
  const Eigen::Vector3d& scanner_world = poses.world_from_scanner.translation;
  // Within one scan line a turn moves far points by decimetres.
  const Eigen::Vector3d start_world =
      poses.motion.ToWorld(observation.start(), observation.start_time_ns());
  const Eigen::Vector3d end_world =
      poses.motion.ToWorld(observation.end(), observation.end_time_ns());
  const Eigen::Vector3d centroid_world = CentroidWorld(observation, start_world, end_world);
  const Eigen::Vector3d scan_normal =
      poses.world_from_scanner.rotation * Eigen::Vector3d::UnitZ();
  const double pose_variance = MaxVariance(
      pose_covariance, (centroid_world - poses.world_from_body.translation).squaredNorm());
  const Eigen::Matrix2d flatness =
      FlatnessCovariance(observation.length_m(), options.surface_flatness_m);
  const double own_variance =
      2.0 * (pose_variance + observation.sigma_offset_m * observation.sigma_offset_m) +
      flatness(0, 0);
  const double gate = TwoDegreesQuantile(options.significance);
  for (const LandmarkView& view : views) {
    if (view.SignedDistance(scanner_world) <= 0.0) continue;
    std::optional<LandmarkView> near;
    const LandmarkView& plane = view.Near(centroid_world, &near);
    const double min_sine = MinCuttingSine(view);
    if (scan_normal.cross(plane.normal).squaredNorm() < min_sine * min_sine) continue;
    // Cheap first: a distance that no covariance can explain.
    const double offset = view.SignedDistance(centroid_world);
    const double max_variance = own_variance + plane.DistanceVariance(centroid_world);
    if (offset * offset > kCoarseMargin * gate * max_variance) continue;
    if (!view.landmark->extent.IsNear(start_world, end_world, options.max_gap_m)) {
      continue;
    }
    const LineDeviation deviation = DeviationFromPlane(observation, poses, view);
    const Eigen::Matrix2d noise =
        deviation.covariance + flatness +
        deviation.by_plane * view.covariance * deviation.by_plane.transpose();
    const Eigen::Matrix<double, 2, 6> by_pose = deviation.by_pose.lazyProduct(pose_covariance);
    const Eigen::Matrix2d covariance =
        noise + by_pose.lazyProduct(deviation.by_pose.transpose());
    const double distance2 = deviation.value.dot(covariance.inverse() * deviation.value);
    if (!(distance2 < gate)) continue;
    visit(Hypothesis{view.landmark->id,
                     deviation,
                     noise,
                     distance2,
                     distance2 + std::log(covariance.determinant())});
  }
}

}  // namespace

std::vector<Hypothesis> HypothesesOf(const Observation& observation,
                                     const ObservationPoses& poses,
                                     const Matrix6d& pose_covariance,
                                     const std::vector<LandmarkView>& views,
                                     const AssociationOptions& options) {
  std::vector<Hypothesis> all;
  VisitHypotheses(
      observation, poses, pose_covariance, views, options, [&](const Hypothesis& hypothesis) {
        all.push_back(hypothesis);
      });
  return all;
}

int FindLandmark(const Observation& observation,
                 const ObservationPoses& poses,
                 const Matrix6d& pose_covariance,
                 const std::vector<LandmarkView>& views,
                 const AssociationOptions& options) {
  double best_score = std::numeric_limits<double>::infinity();
  int best_id = -1;
  VisitHypotheses(
      observation, poses, pose_covariance, views, options, [&](const Hypothesis& hypothesis) {
        if (hypothesis.score >= best_score) return;
        best_score = hypothesis.score;
        best_id = hypothesis.id;
      });
  return best_id;
}

}  // namespace plumbline
