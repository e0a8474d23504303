#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "core/following/scan_follower.h"
#include "core/options/mapper_options.h"
#include "core/sensor/beam_instant.h"
#include "core/sensor/scan_reader.h"
#include "core/util/time.h"
#include "test/testing/six_walls.h"

namespace plumbline {

// A rig of three scanners that moves straight on through a room of six walls. What it measures
// comes scan by scan.
class RoomWalk {
 public:
  static constexpr int64_t kStartNs = SixWalls::kStartNs;
  static constexpr double kPeriod = 0.025;  // s
  static constexpr double kRangeNoise = SixWalls::kRangeNoise;
  static constexpr double kMaxSigmas = 4.5;  // not to be exceeded once in 100,000 times

  explicit RoomWalk(const Eigen::Vector3d& velocity_m_s = Eigen::Vector3d::Zero())
      : velocity_m_s_(velocity_m_s) {
    for (Scanner& scanner : rig_.scanners) scanner.range_noise_m = kRangeNoise;
  }

  const Rig& rig() const { return rig_; }
  PlaneScene& room() { return room_; }
  int64_t now_ns() const { return kStartNs + num_scans_ * NanosecondsFromSeconds(kPeriod); }

  Rigid3d WorldFromBody(int64_t time_ns) const {
    return {Eigen::Quaterniond::Identity(),
            SecondsBetween(kStartNs, std::min(time_ns, stop_ns_)) * velocity_m_s_};
  }
  // The rig stands still from now on.
  void Stop() { stop_ns_ = now_ns(); }

  // The next scan of the room, with noise.
  Scan Take() {
    Scan scan;
    const auto pose = [&](int64_t time_ns) { return WorldFromBody(time_ns); };
    scan.scan_lines = SixWalls::Take(room_, rig_, now_ns(), pose, &random_);
    for (size_t i = 0; i < scan.scan_lines.size(); ++i) {
      scan.scan_line_indices.push_back(num_scan_lines_++);
    }
    const ScanLine& line = scan.scan_lines.front();
    scan.start_ns = BeamInstant(line, 0, rig_);
    scan.end_ns = BeamInstant(line, line.num_beams() - 1, rig_);
    ++num_scans_;
    return scan;
  }

  // The next scan, of which no beam returns.
  Scan TakeBlind() {
    Scan scan = Take();
    for (ScanLine& line : scan.scan_lines) {
      line.ranges.assign(line.ranges.size(), std::numeric_limits<float>::infinity());
    }
    return scan;
  }

 private:
  Eigen::Vector3d velocity_m_s_;
  int64_t stop_ns_ = std::numeric_limits<int64_t>::max();
  Rig rig_ = MakePaperRig();
  PlaneScene room_ = SixWalls::Room();
  std::mt19937_64 random_{7};
  int num_scans_ = 0;
  int num_scan_lines_ = 0;
};

// The plane of the room that a landmark is, in the model frame. The body stands in the model
// frame's origin and in the room's when the walk starts, turned by model_from_room.
inline const ScenePlane* PlaneOf(const Landmark& landmark,
                                 const PlaneScene& room,
                                 const Eigen::Quaterniond& model_from_room) {
  constexpr double kMinCosine = 0.98;    // the room's walls differ by 50 degrees and more
  constexpr double kMaxDistance = 0.15;  // m
  for (const ScenePlane& plane : room) {
    if (landmark.Normal().dot(model_from_room * plane.normal) > kMinCosine &&
        std::abs(landmark.Distance() - plane.distance) < kMaxDistance) {
      return &plane;
    }
  }
  return nullptr;
}

// The rotation into the model frame, exact: its x axis is the normal of the first landmark.
inline Eigen::Quaterniond ModelFromRoom(const MapState& state, const PlaneScene& room) {
  const Eigen::Quaterniond about =
      state.trajectory.WorldFromBody(state.origin_time_ns).rotation;
  const ScenePlane* wall = PlaneOf(state.landmarks.front(), room, about);
  if (wall == nullptr) return about;
  return Eigen::Quaterniond(Eigen::AngleAxisd(-std::atan2(wall->normal.y(), wall->normal.x()),
                                              Eigen::Vector3d::UnitZ()));
}

}  // namespace plumbline
