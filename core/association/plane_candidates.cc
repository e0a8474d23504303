#include "core/association/plane_candidates.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/association/plane_kind.h"
#include "core/association/surface_levels.h"
#include "core/geometry/matrix_types.h"
#include "core/surface/landmark_view.h"
#include "core/surface/patch_extent.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// Traces are no steeper than what they lie on: these are on no ramp.
const double kSteepSine = std::sin(30.0 * M_PI / 180.0);
// A segment closer to the vertical than this does not show its wall's direction.
const double kMinHorizontalPart = std::sin(5.0 * M_PI / 180.0);

Eigen::Vector3d Lift(const Eigen::Vector2d& p) { return {p.x(), p.y(), 0.0}; }

// Kalman update of the landmark's parameters by a deviation from it, the poses taken as given.
void Update(const LineDeviation& deviation, const Eigen::Matrix2d& noise, Landmark* landmark) {
  const int size = landmark->num_parameters();
  const Eigen::MatrixXd design = deviation.by_plane.leftCols(size);
  const Eigen::Matrix2d weight = noise.inverse();
  const Eigen::MatrixXd prior = landmark->covariance.topLeftCorner(size, size).inverse();
  const Eigen::MatrixXd covariance = (prior + design.transpose() * weight * design).inverse();
  const Eigen::VectorXd step =
      -(covariance * (design.transpose() * (weight * deviation.value)));
  for (int i = 0; i < size; ++i) landmark->parameters[static_cast<size_t>(i)] += step[i];
  landmark->covariance.topLeftCorner(size, size) = covariance;
}

// Makes a wall whose segments show that it bends a cylinder. While something moves, it waits
// for some age: what a leaf that swings has smeared looks bent. Returns whether the tentative
// plane may become a landmark.
bool BendWhereShown(bool needs_age, const PlaneOptions& options, TentativePlane* plane) {
  std::optional<Landmark> cylinder = plane->bend.Solve();
  if (!cylinder) return true;
  if (needs_age && SecondsBetween(plane->first_time_ns, plane->last_time_ns) <=
                       options.min_age_of_small_s) {
    return false;
  }
  cylinder->extent.Merge(plane->landmark.extent);
  plane->landmark = std::move(*cylinder);
  return true;
}

void Record(const Observation& observation,
            int observation_index,
            const ObservationPoses& poses,
            const TypeEvidence& evidence,
            const MeasuredLine& line,
            TentativePlane* plane) {
  const Rigid3d& world_from_scanner = poses.world_from_scanner;
  plane->landmark.extent.AddSegment(world_from_scanner * Lift(observation.start()),
                                    world_from_scanner * Lift(observation.end()));
  plane->Count(observation, observation_index, poses, line);
  if (evidence.can_be_horizontal != evidence.can_be_vertical) {
    plane->clear_scans.insert(observation.scan_index);
  }
}

}  // namespace

TypeEvidence JudgeType(const Observation& observation,
                       const Eigen::Quaterniond& world_from_scanner,
                       double direction_sigma_rad,
                       double significance) {
  const Eigen::Vector3d direction = world_from_scanner * Lift(observation.tangent());
  const Eigen::Vector3d scan_normal = world_from_scanner * Eigen::Vector3d::UnitZ();
  const double tilt_sine = scan_normal.head<2>().norm();
  const double sigmas = std::sqrt(TwoDegreesQuantile(significance));
  // A scan plane that is tilted by less than this grazes horizontal planes: a horizontal
  // segment speaks for a wall.
  const bool cuts_level = tilt_sine > kMinCuttingSineOfSlopes;
  TypeEvidence evidence;
  evidence.can_be_horizontal =
      cuts_level && std::abs(direction.z()) < sigmas * direction_sigma_rad * tilt_sine;
  evidence.can_be_vertical = direction.head<2>().norm() > kMinHorizontalPart;
  evidence.is_wall =
      evidence.can_be_vertical && (!cuts_level || std::abs(direction.z()) > kSteepSine);
  return evidence;
}

TentativePlanes::TentativePlanes(bool planar,
                                 const MapperOptions& options,
                                 double range_noise_m,
                                 bool knows_turns)
    : planar_(planar),
      options_(options),
      range_noise_m_(range_noise_m),
      knows_turns_(knows_turns),
      undecided_(options) {}

bool TentativePlanes::Matches(const TentativePlane& plane,
                              const Observation& observation,
                              const LineDeviation& deviation,
                              const ObservationPoses& poses,
                              const Matrix6d& pose_covariance) const {
  const Rigid3d& world_from_scanner = poses.world_from_scanner;
  const Landmark& landmark = plane.landmark;
  if (landmark.SignedDistance(world_from_scanner.translation) <= 0.0) return false;
  if (!landmark.extent.IsNear(world_from_scanner * Lift(observation.start()),
                              world_from_scanner * Lift(observation.end()),
                              options_.association.max_gap_m)) {
    return false;
  }
  const Eigen::Matrix2d covariance =
      deviation.covariance + FlatnessOf(observation) +
      deviation.by_pose * pose_covariance * deviation.by_pose.transpose() +
      deviation.by_plane * landmark.covariance * deviation.by_plane.transpose();
  return deviation.value.dot(covariance.inverse() * deviation.value) <
         TwoDegreesQuantile(options_.association.significance);
}

TypeEvidence TentativePlanes::EvidenceOf(const Observation& observation,
                                         const ObservationPoses& poses,
                                         const Matrix6d& pose_covariance) const {
  if (planar_) return {false, true, true};
  const double direction_sigma =
      std::sqrt(observation.sigma_direction_rad * observation.sigma_direction_rad +
                pose_covariance.topLeftCorner<3, 3>().trace() + FlatnessOf(observation)(1, 1));
  return JudgeType(observation,
                   poses.world_from_scanner.rotation,
                   direction_sigma,
                   options_.association.significance);
}

Eigen::Matrix2d TentativePlanes::FlatnessOf(const Observation& observation) const {
  return FlatnessCovariance(observation.length_m(), options_.association.surface_flatness_m);
}

void TentativePlanes::Offer(const Observation& observation,
                            int observation_index,
                            const ObservationPoses& poses,
                            const Matrix6d& pose_covariance,
                            bool founds_wall) {
  TypeEvidence evidence = EvidenceOf(observation, poses, pose_covariance);
  if (founds_wall) evidence = {false, true, true};
  const MeasuredLine line = MeasureLine(
      observation, poses, pose_covariance, options_.association.surface_flatness_m);
  if (!planar_) undecided_.Offer(observation, observation_index, poses, line);
  bool taken = false;
  for (TentativePlane& plane : planes_) {
    const bool is_allowed =
        VisitPlaneModel(plane.landmark.model, plane.landmark.chart, [&](const auto& kind) {
          return evidence.Allows(kind);
        });
    if (!is_allowed) continue;
    const LineDeviation deviation =
        DeviationFromPlane(observation, poses, LandmarkView(plane.landmark));
    if (!Matches(plane, observation, deviation, poses, pose_covariance)) continue;
    Update(deviation, deviation.covariance + FlatnessOf(observation), &plane.landmark);
    Record(observation, observation_index, poses, evidence, line, &plane);
    plane.bend.Add(observation, poses, pose_covariance);
    taken = true;
  }
  const double max_sigma = options_.planes.max_direction_sigma_deg * M_PI / 180.0;
  if (!taken && (evidence.can_be_horizontal || evidence.is_wall) &&
      observation.num_points >= options_.planes.min_points &&
      !(observation.sigma_direction_rad > max_sigma)) {
    Start(observation, observation_index, poses, evidence, line);
    planes_.back().bend.Add(observation, poses, pose_covariance);
  }
}

void TentativePlanes::Start(const Observation& observation,
                            int observation_index,
                            const ObservationPoses& poses,
                            const TypeEvidence& evidence,
                            const MeasuredLine& line) {
  const Rigid3d& world_from_scanner = poses.world_from_scanner;
  const Eigen::Vector3d centroid = world_from_scanner * Lift(observation.centroid());
  TentativePlane plane;
  if (evidence.can_be_horizontal) {
    const double sign = world_from_scanner.translation.z() > centroid.z() ? 1.0 : -1.0;
    plane.landmark = MakeHorizontalLandmark(sign, centroid);
  } else if (evidence.can_be_vertical) {
    const Eigen::Vector3d direction =
        world_from_scanner.rotation * Lift(observation.tangent());
    Eigen::Vector3d normal = direction.cross(Eigen::Vector3d::UnitZ());
    if (normal.dot(world_from_scanner.translation - centroid) < 0.0) normal = -normal;
    plane.landmark = MakeVerticalLandmark(normal, centroid);
    plane.bend =
        BendTest(plane.landmark, options_.association.surface_flatness_m, range_noise_m_);
  } else {
    return;
  }
  const LineDeviation deviation =
      DeviationFromPlane(observation, poses, LandmarkView(plane.landmark));
  const int size = plane.landmark.num_parameters();
  const Eigen::MatrixXd design = deviation.by_plane.leftCols(size);
  const Eigen::Matrix2d noise = deviation.covariance + FlatnessOf(observation);
  plane.landmark.covariance.topLeftCorner(size, size) =
      (design.transpose() * noise.inverse() * design).inverse();
  Record(observation, observation_index, poses, evidence, line, &plane);
  planes_.push_back(std::move(plane));
}

bool TentativePlanes::IsReady(const TentativePlane& plane,
                              int min_scans,
                              bool needs_age,
                              int min_scanners) const {
  if (static_cast<int>(plane.scans.size()) < min_scans) return false;
  if (needs_age && !plane.HasAge(options_.planes)) return false;
  if (plane.landmark.model == PlaneModel::kVertical) {
    if (static_cast<int>(plane.scanners.size()) < min_scanners) return false;
    // The surface's unevenness is the same in every scan: it does not average out.
    const PatchExtent& extent = plane.landmark.extent;
    const double length_m = extent.max_corner().x() - extent.min_corner().x();
    const double variance =
        plane.landmark.covariance(0, 0) +
        FlatnessCovariance(length_m, options_.association.surface_flatness_m)(1, 1);
    const double max_sigma = options_.planes.max_direction_sigma_deg * M_PI / 180.0;
    // A single segment that took in beams of another surface slopes: it would make a wall of
    // level ones on a lintel.
    const bool has_clear_type =
        planar_ || static_cast<int>(plane.clear_scans.size()) >= min_scans;
    return has_clear_type && variance < max_sigma * max_sigma;
  }
  // One scanner's level segments may lie on a wall.
  const double way_m = knows_turns_ ? std::max(plane.Motion(), plane.swept_m) : plane.Motion();
  if (plane.scanners.size() < 2 && !(way_m > kRevealingMotion)) return false;
  // Single traces of a gentle ramp look level; small surfaces may be level.
  const Eigen::Vector2d size =
      plane.landmark.extent.max_corner() - plane.landmark.extent.min_corner();
  if (min_scans <= 1 || size.maxCoeff() < kShowingWidth) return true;
  const PlaneThroughLines::Fit fit = plane.lines.Solve();
  if (fit.normal_covariance.trace() > kDecidedSigma * kDecidedSigma) return true;
  const std::optional<Landmark> shown = DecideKind(fit, plane.landmark.extent.axes().anchor);
  return shown && shown->model == plane.landmark.model;
}

std::vector<TentativePlane> TentativePlanes::TakeReady(int min_scans,
                                                       bool needs_age,
                                                       int min_scanners) {
  std::vector<TentativePlane> ready;
  for (auto it = planes_.begin(); it != planes_.end();) {
    const bool is_ready = IsReady(*it, min_scans, needs_age, min_scanners);
    if (is_ready && it->landmark.model == PlaneModel::kVertical &&
        undecided_.AreOnNoWall(it->observations, min_scans)) {
      it = planes_.erase(it);
    } else if (is_ready && BendWhereShown(needs_age, options_.planes, &*it)) {
      ready.push_back(std::move(*it));
      it = planes_.erase(it);
    } else {
      ++it;
    }
  }
  for (TentativePlane& plane : undecided_.TakeReady(min_scans, needs_age)) {
    ready.push_back(std::move(plane));
  }
  return ready;
}

void TentativePlanes::DropStale(int64_t now_ns) {
  undecided_.DropStale(now_ns);
  const auto is_stale = [&](const TentativePlane& plane) {
    return SecondsBetween(plane.last_time_ns, now_ns) > options_.planes.max_tentative_age_s;
  };
  planes_.erase(std::remove_if(planes_.begin(), planes_.end(), is_stale), planes_.end());
}

}  // namespace plumbline
