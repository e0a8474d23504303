#include "core/map/map_state.h"

#include <algorithm>

namespace plumbline {
namespace {

// Leaves a landmark as it is before its first observation is counted.
void Empty(Landmark* landmark) {
  landmark->extent = landmark->EmptyExtent();
  landmark->num_segments = 0;
  landmark->num_points = 0;
  landmark->last_scan = 0;
  landmark->last_time_ns = 0;
}

}  // namespace

bool MapState::IsMapped(int64_t time_ns) const {
  if (time_ns < trajectory.start_ns() || time_ns >= trajectory.end_ns()) return false;
  return std::none_of(gaps.begin(), gaps.end(), [time_ns](const MapGap& gap) {
    return time_ns >= gap.start_ns && time_ns < gap.end_ns;
  });
}

Matrix6d ScannerCovariance(const Rig& rig,
                           const MapState& state,
                           const Observation& observation) {
  const auto index = static_cast<size_t>(observation.scanner_index);
  if (index >= state.calibration.scanners.size()) return Matrix6d::Zero();
  const ScannerEstimate& scanner = state.calibration.scanners[index];
  if (!scanner.IsEstimated()) return Matrix6d::Zero();
  const Scanner& rig_scanner = rig.scanners[index];
  const int64_t time_ns = observation.middle_time_ns();
  Eigen::Vector3d angular;
  Eigen::Vector3d linear;
  state.trajectory.Velocity(time_ns, &angular, &linear);
  const Eigen::Matrix3d world_from_body =
      state.trajectory.WorldFromBody(time_ns).rotation.toRotationMatrix();
  const ScannerPose pose =
      PoseOfScanner({scanner.stated.rotation.toRotationMatrix(), scanner.stated.translation},
                    scanner.block.data());
  Matrix6d covariance;
  if (scanner.is_mounted) {
    const BodyByMounted by_scanner =
        BodyMotionByMounted(world_from_body,
                            pose,
                            scanner.stated_mount,
                            MotionOf(*rig_scanner.mount, time_ns, rig_scanner.delay_s),
                            scanner.block.data(),
                            angular,
                            linear);
    covariance = by_scanner * scanner.covariance * by_scanner.transpose();
  } else {
    const BodyByScanner by_scanner =
        BodyMotionByScanner(world_from_body, pose, scanner.block.data(), angular, linear);
    covariance = by_scanner *
                 scanner.covariance.topLeftCorner<kScannerBlockSize, kScannerBlockSize>() *
                 by_scanner.transpose();
  }
  // An error of the ranges to one surface is a shift along its normal, which can be any.
  const Eigen::Vector2d by_errors(1.0, observation.centroid().norm());
  covariance.bottomRightCorner<3, 3>().diagonal().array() +=
      by_errors.dot(scanner.covariance.block<kNumRangeErrors, kNumRangeErrors>(
                        kScannerRangeAt, kScannerRangeAt) *
                    by_errors);
  return covariance;
}

void CountObservation(const Observation& observation,
                      const ObservationPoses& poses,
                      MapState* state) {
  Landmark& landmark = state->landmarks[static_cast<size_t>(observation.landmark_id)];
  landmark.extent.AddSegment(
      poses.motion.ToWorld(observation.start(), observation.start_time_ns()),
      poses.motion.ToWorld(observation.end(), observation.end_time_ns()));
  if (landmark.num_segments == 0) {
    landmark.first_scan = observation.scan_index;
    landmark.first_time_ns = observation.start_time_ns();
  }
  landmark.last_scan = std::max(landmark.last_scan, observation.scan_index);
  landmark.last_time_ns = std::max(landmark.last_time_ns, observation.end_time_ns());
  ++landmark.num_segments;
  landmark.num_points += observation.num_points;
}

void RebuildLandmarks(const Rig& rig, MapState* state) {
  RebuildLandmarks(rig, std::vector<bool>(state->landmarks.size(), true), state);
}

void RebuildLandmarks(const Rig& rig, const std::vector<bool>& is_chosen, MapState* state) {
  for (Landmark& landmark : state->landmarks) {
    if (is_chosen[static_cast<size_t>(landmark.id)]) Empty(&landmark);
  }
  SharedPoses poses(rig, state->trajectory);
  for (const Observation& observation : state->observations) {
    const int id = observation.landmark_id;
    if (id < 0 || !is_chosen[static_cast<size_t>(id)]) continue;
    CountObservation(observation, poses.Of(observation), state);
  }
  for (const Observation& segment : state->sub_minimum_segments) {
    const auto id = static_cast<size_t>(segment.landmark_id);
    Landmark& landmark = state->landmarks[id];
    if (!is_chosen[id] || landmark.num_segments == 0) continue;
    landmark.num_points += segment.num_points;
  }
}

void RecountSegments(MapState* state) {
  for (Landmark& landmark : state->landmarks) landmark.num_segments = 0;
  for (const Observation& observation : state->observations) {
    if (observation.landmark_id < 0) continue;
    ++state->landmarks[static_cast<size_t>(observation.landmark_id)].num_segments;
  }
}

void KeepHeadingHeld(MapState* state) {
  std::vector<int> num_segments(state->landmarks.size(), 0);
  for (const Observation& observation : state->observations) {
    if (observation.landmark_id >= 0)
      ++num_segments[static_cast<size_t>(observation.landmark_id)];
  }
  Landmark* most = nullptr;
  for (Landmark& landmark : state->landmarks) {
    const int own = num_segments[static_cast<size_t>(landmark.id)];
    if (!TraitsOf(landmark).has_heading || own == 0) continue;
    if (landmark.heading_fixed) return;
    if (most == nullptr || own > num_segments[static_cast<size_t>(most->id)]) most = &landmark;
  }
  for (Landmark& landmark : state->landmarks) landmark.heading_fixed = &landmark == most;
}

int ReleaseObservations(const std::vector<bool>& is_chosen, MapState* state) {
  const auto is_released = [&](int id) {
    const auto index = static_cast<size_t>(id);
    return is_chosen[index] && !state->landmarks[index].heading_fixed;
  };
  int num_released = 0;
  for (Observation& observation : state->observations) {
    if (observation.landmark_id < 0 || !is_released(observation.landmark_id)) continue;
    observation.landmark_id = -1;
    ++num_released;
  }
  std::deque<Observation>& segments = state->sub_minimum_segments;
  segments.erase(std::remove_if(segments.begin(),
                                segments.end(),
                                [&](const Observation& segment) {
                                  return is_released(segment.landmark_id);
                                }),
                 segments.end());
  for (Landmark& landmark : state->landmarks) {
    if (is_released(landmark.id)) Empty(&landmark);
  }
  return num_released;
}

}  // namespace plumbline
