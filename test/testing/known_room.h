#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/map/map_state.h"
#include "core/map/observation.h"
#include "core/segmentation/segmentation.h"
#include "core/surface/landmark.h"
#include "core/trajectory/pose_gaussian.h"
#include "test/testing/room_walk.h"

namespace plumbline {

// A walk through a room whose planes are landmarks already, known well, in the room's frame.
class KnownRoom {
 public:
  static constexpr double kPlaneSigma = 1e-3;  // rad and m

  explicit KnownRoom(const Eigen::Vector3d& velocity_m_s) : walk_(velocity_m_s) {
    for (const ScenePlane& plane : walk_.room()) AddLandmark(plane);
    state_.landmarks.front().heading_fixed = true;  // the gauge
    state_.landmarks.front().covariance(0, 0) = 0.0;
  }

  const Rig& rig() const { return walk_.rig(); }
  const RoomWalk& walk() const { return walk_; }
  MapState& state() { return state_; }

  // Takes the next scan's segments into the state: (first, last) of its observations.
  std::pair<int, int> Observe() {
    const Scan scan = walk_.Take();
    end_ns_ = scan.end_ns;
    state_.trajectory.ExtendTo(end_ns_);
    const int first = static_cast<int>(state_.observations.size());
    for (const ScanLine& line : scan.scan_lines) {
      const Scanner& scanner = rig().scanners[static_cast<size_t>(line.scanner_index)];
      for (const Segment& segment : SegmentScanLine(line, scanner, {}, {})) {
        state_.observations.push_back(MakeObservation(line, scanner, segment, false));
        state_.observations.back().scan_index = num_scans_;
      }
    }
    ++num_scans_;
    return {first, static_cast<int>(state_.observations.size()) - 1};
  }
  // What is known of the start: the control points to 0.2 m and 3 degrees.
  PoseGaussian Start() {
    constexpr double kPosition = 0.2;   // m
    constexpr double kRotation = 0.05;  // rad
    state_.trajectory.ExtendTo(RoomWalk::kStartNs);
    PoseGaussian start;
    for (int i = 0; i < state_.trajectory.num_control_points(); ++i) {
      start.mean.push_back(state_.trajectory.control_point(i));
    }
    const auto size = static_cast<Eigen::Index>(6 * start.mean.size());
    start.information.setZero(size, size);
    for (Eigen::Index row = 0; row < size; ++row) {
      const double sigma = row % 6 < 3 ? kRotation : kPosition;
      start.information(row, row) = 1.0 / (sigma * sigma);
    }
    return start;
  }
  int64_t end_ns() const { return end_ns_; }
  int scan_index() const { return num_scans_ - 1; }

 private:
  void AddLandmark(const ScenePlane& plane) {
    constexpr double kHalfWidth = 4.0;  // m, more than the room's
    const Eigen::Vector3d foot = plane.distance * plane.normal;
    const bool level = std::abs(plane.normal.z()) > 0.5;
    Landmark landmark = level ? MakeHorizontalLandmark(plane.normal.z(), foot)
                              : MakeVerticalLandmark(plane.normal, foot);
    for (double v = -kHalfWidth; v <= kHalfWidth; v += PatchExtent::kCellSize) {
      landmark.extent.AddSegment(landmark.extent.ToWorld({-kHalfWidth, v}),
                                 landmark.extent.ToWorld({kHalfWidth, v}));
      ++landmark.num_segments;
    }
    const int size = landmark.num_parameters();
    landmark.covariance.diagonal().head(size).setConstant(kPlaneSigma * kPlaneSigma);
    landmark.id = static_cast<int>(state_.landmarks.size());
    state_.landmarks.push_back(std::move(landmark));
  }

  RoomWalk walk_;
  MapState state_{
      Trajectory(RoomWalk::kStartNs, 125'000'000, Rigid3d()), {}, {}, RoomWalk::kStartNs, {}};
  int64_t end_ns_ = 0;
  int num_scans_ = 0;
};

}  // namespace plumbline
