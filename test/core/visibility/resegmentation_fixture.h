#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/visibility/resegmentation.h"
#include "simulation/sensing/recording_writer.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {

inline constexpr int64_t kStart = 1'600'000'000'000'000'000;
inline constexpr double kDegree = M_PI / 180.0;
inline constexpr int kLast = 116;  // of the front wall; beam i points to i - 90 degrees
inline constexpr int kFront = 0;   // landmark ids
inline constexpr int kSide = 1;

// A scanner at rest in the origin sees a wall in front, x = 2 up to y = 1, and one at its
// left, y = 1. They meet at 26.57 degrees.
class ResegmentationTest : public TemporaryDirectoryTest {
 protected:
  void SetUp() override {
    TemporaryDirectoryTest::SetUp();
    rig_.scanners.resize(1);
    rig_.scanners[0].name = "level";
    rig_.scanners[0].topic = "/scan";
    line_.stamp_ns = kStart;
    line_.angle_min = -90.0 * kDegree;
    line_.angle_increment = kDegree;
    line_.time_increment_s = 1e-4;
    for (int beam = 0; beam <= 180; ++beam) line_.ranges.push_back(Range(beam));
    state_ = std::make_unique<MapState>(
        MapState{Trajectory(kStart, 125'000'000, Rigid3d()), {}, {}, kStart, {}});
    state_->trajectory.ExtendTo(kStart + 100'000'000);
    AddWall({-1.0, 0.0, 0.0}, {2.0, -3.0, 0.0}, {2.0, 1.0, 0.0});
  }

  void AddWall(const Eigen::Vector3d& normal,
               const Eigen::Vector3d& from,
               const Eigen::Vector3d& to) {
    Landmark wall = MakeVerticalLandmark(normal, from);
    wall.id = static_cast<int>(state_->landmarks.size());
    wall.extent.AddSegment(from, to);
    wall.extent.AddSegment(from + Eigen::Vector3d::UnitZ(), to + Eigen::Vector3d::UnitZ());
    wall.num_segments = 1;
    state_->landmarks.push_back(wall);
  }
  void AddSideWall(double end_x) {
    AddWall({0.0, -1.0, 0.0}, {-2.0, 1.0, 0.0}, {end_x, 1.0, 0.0});
  }

  static float Range(int beam) {
    const double angle = (beam - 90) * kDegree;
    const double front = std::cos(angle) > 1e-6 ? 2.0 / std::cos(angle) : 1e9;
    const double side = std::sin(angle) > 1e-6 ? 1.0 / std::sin(angle) : 1e9;
    return static_cast<float>(std::min({front, side, 20.0}));
  }

  void AddObservation(int landmark_id, int first, int last) {
    Segment segment;
    segment.first_beam = first;
    segment.last_beam = last;
    segment.num_points = last - first + 1;
    const Landmark& landmark = state_->landmarks[static_cast<size_t>(landmark_id)];
    segment.normal =
        (rig_.scanners[0].body_from_scanner.rotation.conjugate() * landmark.Normal())
            .head<2>();
    Observation observation = MakeObservation(line_, rig_.scanners[0], segment, false);
    observation.landmark_id = landmark_id;
    state_->observations.push_back(observation);
  }

  int Resegment(bool last = false) {
    const std::string path = (directory_ / "recording.bag").string();
    RecordingWriter writer(path, rig_);
    ScanLine line = line_;
    for (int index = 0; index <= state_->observations.back().scan_line_index; ++index) {
      line.stamp_ns = line_.stamp_ns + index * 25'000'000;
      writer.Write(line);
    }
    writer.Close();
    RecordingReader recording(path, rig_);
    OccupancyGrids counted;
    std::vector<LevelOnSurface> levels;
    const MapperOptions options;
    const int num_resegmented = ResegmentRecording(
        rig_,
        options,
        &recording,
        [&](int64_t /*time_ns*/) { return pose_covariance_; },
        openings_.OpeningsOf(
            state_->landmarks, options.association.surface_flatness_m, &levels),
        last ? nullptr : &counted,
        state_.get());
    if (!last) openings_ = std::move(counted);
    return num_resegmented;
  }

  const Observation& observation(size_t i) const { return state_->observations[i]; }

  Rig rig_;
  ScanLine line_;
  Matrix6d pose_covariance_ = Matrix6d::Zero();
  OccupancyGrids openings_;
  std::unique_ptr<MapState> state_;
};

}  // namespace plumbline
