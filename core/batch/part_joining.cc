#include "core/batch/part_joining.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/association/plane_merging.h"
#include "core/batch/part_poses.h"
#include "core/batch/visit_levels.h"
#include "core/geometry/planar_pose.h"
#include "core/geometry/rigid3.h"
#include "core/map/map_frame.h"
#include "core/map/observation_poses.h"
#include "core/registration/part_matching.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// Longest gap over which the motion predicts where the rig comes to, and the accuracy.
// Matching surfaces alone do not tell a place from one that looks like it.
constexpr double kMaxForeseen = 3.5;   // s
constexpr double kMaxDeviation = 2.0;  // m
// Largest difference of equal heights, and the least share of what both parts saw that has to
// agree.
constexpr double kSameHeight = 0.05;      // m
constexpr double kMinAgreement = 0.7;     // share of the segments on floors and ceilings
constexpr int kMinSegmentsOnFloors = 20;  // that both parts saw

Rigid3d ToFrame(const PlanarPose& pose, double height_m) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(pose.heading, Eigen::Vector3d::UnitZ())),
          {pose.position.x(), pose.position.y(), height_m}};
}

// The height to be added to a part's own, so that its floors and ceilings lie where the other
// state saw them; seen from above, the part has the pose given. Nothing where they do not
// agree.
std::optional<double> HeightOf(const Rig& rig,
                               const Rigid3d& to_from,
                               const MapState& part,
                               const MapState& other) {
  std::vector<double> differences;
  SharedPoses poses(rig, part.trajectory);
  for (const Observation& observation : part.observations) {
    if (observation.landmark_id < 0) continue;
    const Landmark& floor = part.landmarks[static_cast<size_t>(observation.landmark_id)];
    const Eigen::Vector3d normal = floor.Normal();
    if (std::abs(normal.z()) < 1.0) continue;  // it is not level
    const Eigen::Vector3d p =
        to_from * (poses.Of(observation).motion.At(observation.middle_time_ns()) *
                   observation.centroid().homogeneous());
    for (const Landmark& landmark : other.landmarks) {
      if (landmark.num_segments == 0 || landmark.Normal() != normal) continue;
      const double height_m = normal.z() * landmark.Distance();
      if (!landmark.extent.IsSeenAt({p.x(), p.y(), height_m}, 0.0)) continue;
      differences.push_back(height_m - normal.z() * floor.Distance());
    }
  }
  if (differences.size() < kMinSegmentsOnFloors) return std::nullopt;
  const double height_m = Median(differences);
  const auto num_agreeing =
      std::count_if(differences.begin(), differences.end(), [height_m](double difference_m) {
        return std::abs(difference_m - height_m) < kSameHeight;
      });
  if (static_cast<double>(num_agreeing) <
      kMinAgreement * static_cast<double>(differences.size())) {
    return std::nullopt;
  }
  return height_m;
}

// How far a surface lies from another one of its kind, m: the largest distance of the points
// at which they are compared.
double DistanceBetween(const Landmark& surface, const Landmark& other) {
  double distance_m = 0.0;
  for (const Eigen::Vector3d& on_axes : ComparedPoints(surface.extent)) {
    const Eigen::Vector3d on_surface =
        on_axes - surface.SignedDistance(on_axes) * surface.NormalNear(on_axes);
    distance_m = std::max(distance_m, std::abs(other.SignedDistance(on_surface)));
  }
  return distance_m;
}

// Makes one of surfaces that a part and what came before it both saw; num_before: the
// landmarks of before.
int MergeCommonSurfaces(size_t num_before, MapState* state) {
  int num_merged = 0;
  for (size_t b = num_before; b < state->landmarks.size(); ++b) {
    const Landmark& surface = state->landmarks[b];
    if (surface.num_segments == 0) continue;
    const Eigen::Vector3d centre = surface.extent.Centre();
    const Eigen::Vector3d normal = surface.NormalNear(centre).normalized();
    int nearest = -1;
    double least_m = kSameSurfaceDistance;
    for (size_t a = 0; a < num_before; ++a) {
      const Landmark& before = state->landmarks[a];
      if (before.num_segments == 0 || before.model != surface.model) continue;
      if (before.NormalNear(centre).normalized().dot(normal) < kSameNormalCosine) continue;
      const double distance_m = DistanceBetween(surface, before);
      if (distance_m >= least_m) continue;
      if (!before.extent.IsNear(surface.extent, kSameSurfaceGap)) continue;
      nearest = static_cast<int>(a);
      least_m = distance_m;
    }
    if (nearest < 0) continue;
    MergeInto(nearest, static_cast<int>(b), state);
    ++num_merged;
  }
  return num_merged;
}

// Appends the later part, in the same frame, to the earlier one.
void Append(const Rig& rig, FollowedPart later, FollowedPart* earlier) {
  MapState& state = earlier->state;
  const auto num_scans = static_cast<int>(earlier->scan_times_ns.size());
  const auto num_landmarks = static_cast<int>(state.landmarks.size());
  const int64_t gap_start_ns = state.observations.back().end_time_ns() + 1;
  const int64_t gap_end_ns = later.scan_times_ns.front();
  state.gaps.push_back({std::min(gap_start_ns, gap_end_ns), gap_end_ns, earlier->ended_by});
  state.trajectory.Append(later.state.trajectory);
  for (Landmark& landmark : later.state.landmarks) {
    landmark.id += num_landmarks;
    landmark.heading_fixed = false;
    landmark.first_scan += num_scans;
    landmark.last_scan += num_scans;
    state.landmarks.push_back(std::move(landmark));
  }
  for (auto observations : {&MapState::observations, &MapState::sub_minimum_segments}) {
    for (Observation& observation : later.state.*observations) {
      observation.scan_index += num_scans;
      if (observation.landmark_id >= 0) observation.landmark_id += num_landmarks;
      if (observation.taken_to >= 0) observation.taken_to += num_landmarks;
      (state.*observations).push_back(std::move(observation));
    }
  }
  std::move(later.state.moving_beams.begin(),
            later.state.moving_beams.end(),
            std::back_inserter(state.moving_beams));
  // The longer one has shown more of the scanners.
  if (later.scan_times_ns.size() > earlier->scan_times_ns.size()) {
    state.calibration = later.state.calibration;
    if (state.calibration.imu) state.calibration.imu->biases.resize(1);  // of other instants
  }
  earlier->scan_times_ns.insert(
      earlier->scan_times_ns.end(), later.scan_times_ns.begin(), later.scan_times_ns.end());
  const int num_merged = MergeCommonSurfaces(static_cast<size_t>(num_landmarks), &state);
  RebuildLandmarks(state.calibration.Posed(rig), &state);
  LOG(INFO) << "joined the part from " << FormatSeconds(later.start_s) << " to "
            << FormatSeconds(later.end_s) << ": " << num_merged << " surfaces in common";
  earlier->end_s = later.end_s;
  earlier->ended_by = later.ended_by;
}

// Returns the pose to which the motion at the end of a part leads in a time.
Eigen::Vector3d Foreseen(const FollowedPart& part, double time_s) {
  const int64_t end_ns = part.scan_times_ns.back();
  Eigen::Vector3d angular;
  Eigen::Vector3d linear;
  part.state.trajectory.Velocity(end_ns, &angular, &linear);
  return part.state.trajectory.WorldFromBody(end_ns).translation + time_s * linear;
}

// Returns the pose of the later part in the frame of the earlier one by the wheels, of a rig
// that moves in the plane; nothing where they do not cover the time between them.
std::optional<PlanarPose> PoseByWheels(const FollowedPart& earlier,
                                       const FollowedPart& later) {
  const MapState& state = earlier.state;
  if (state.odometry == nullptr) return std::nullopt;
  const int64_t end_ns = earlier.scan_times_ns.back();
  const int64_t start_ns = later.scan_times_ns.front();
  const std::optional<PlanarMotion> stated = state.odometry->Between(end_ns, start_ns);
  if (!stated) return std::nullopt;
  const OdometryMeasurement motion = state.odometry_calibration.Measure(*stated);
  const PlanarPose start = FromAbove(state.trajectory.WorldFromBody(end_ns)) *
                           PlanarPose{motion.turn, motion.translation};
  return start * FromAbove(later.state.trajectory.WorldFromBody(start_ns)).Inverse();
}

// Returns the pose of the later part in the frame of the earlier one, or in words why it is
// not known.
std::optional<Rigid3d> PoseOf(const Rig& rig,
                              bool planar,
                              const FollowedPart& earlier,
                              const FollowedPart& later,
                              std::string* reason) {
  const int64_t start_ns = later.scan_times_ns.front();
  const double time_s = SecondsBetween(earlier.scan_times_ns.back(), start_ns);
  const std::optional<PlanarPose> by_wheels =
      planar ? PoseByWheels(earlier, later) : std::nullopt;
  if (by_wheels) return ToFrame(*by_wheels, 0.0);
  if (time_s > kMaxForeseen) {
    *reason = "it is not known how the rig came there in " + FormatSeconds(time_s);
    return std::nullopt;
  }
  const Eigen::Vector3d foreseen = Foreseen(earlier, time_s);
  const Eigen::Vector3d start = later.state.trajectory.WorldFromBody(start_ns).translation;
  const PartMatchingOptions options;
  const PartMatch match = MatchParts(
      ViewFromAbove(earlier.state.calibration.Posed(rig), earlier.state, options.spacing_m),
      ViewFromAbove(later.state.calibration.Posed(rig), later.state, options.spacing_m),
      options,
      [&](const PlanarPose& pose) {
        const Eigen::Vector3d found = ToFrame(pose, 0.0) * start;
        return (found - foreseen).head<2>().norm() < kMaxDeviation;
      });
  if (!match.pose) {
    *reason = match.reason;
    return std::nullopt;
  }
  const Rigid3d from_above = ToFrame(match.pose->a_from_b, 0.0);
  if (planar) return from_above;
  const auto height_m = HeightOf(rig, from_above, later.state, earlier.state);
  if (!height_m) {
    *reason = "floors and ceilings leave its height open";
    return std::nullopt;
  }
  const Rigid3d pose = ToFrame(match.pose->a_from_b, *height_m);
  if (std::abs((pose * start - foreseen).z()) > kMaxDeviation) {
    *reason = "its floors and ceilings match those of another storey";
    return std::nullopt;
  }
  return pose;
}

}  // namespace

void JoinParts(const Rig& rig, bool planar, FollowedRecording* followed) {
  std::vector<FollowedPart> joined;
  for (FollowedPart& part : followed->parts) {
    std::string reason;
    const std::optional<Rigid3d> pose =
        joined.empty() ? std::nullopt : PoseOf(rig, planar, joined.back(), part, &reason);
    if (pose) {
      MoveMap(part.state.calibration.Posed(rig), *pose, &part.state);
      Append(rig, std::move(part), &joined.back());
      continue;
    }
    if (!reason.empty()) {
      LOG(INFO) << "the part from " << FormatSeconds(part.start_s)
                << " is not joined to the one before: " << reason;
    }
    joined.push_back(std::move(part));
  }
  followed->parts = std::move(joined);
}

}  // namespace plumbline
