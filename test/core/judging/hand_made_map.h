#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

#include "core/judging/sightings.h"
#include "core/map/map_state.h"
#include "core/sensor/rig.h"
#include "core/util/time.h"

namespace plumbline {

// A finished map of a rig that rests at the origin with level scanners: walls across the x
// axis, and segments on them or on none, put in by hand, second by second.
class HandMadeMap {
 public:
  explicit HandMadeMap(int num_scanners = 1) {
    rig_.scanners.resize(static_cast<size_t>(num_scanners));
    for (int i = 0; i < num_scanners; ++i) {
      rig_.scanners[static_cast<size_t>(i)].name = "scanner_" + std::to_string(i);
      rig_.scanners[static_cast<size_t>(i)].range_noise_m = 0.01;
    }
    state_.trajectory.ExtendTo(NanosecondsFromSeconds(60.0));
  }

  const Rig& rig() const { return rig_; }
  MapState& state() { return state_; }

  // A wall that faces the origin.
  int AddWall(double x, double first_y, double last_y) {
    Landmark landmark = MakeVerticalLandmark({-1.0, 0.0, 0.0}, {x, 0.0, 0.0});
    landmark.id = static_cast<int>(state_.landmarks.size());
    landmark.extent.AddSegment({x, first_y, 0.0}, {x, last_y, 0.0});
    landmark.num_segments = 1;
    state_.landmarks.push_back(landmark);
    return landmark.id;
  }

  // Ten segments within a second from (x, first_y) to (x, last_y). Seconds come in order.
  // landmark_id: -1 for none.
  void See(int second, int landmark_id, double x, double first_y, double last_y) {
    SeeAlong(second, landmark_id, {x, first_y}, {x, last_y});
  }
  void SeeAlong(int second,
                int landmark_id,
                const Eigen::Vector2d& first,
                const Eigen::Vector2d& last,
                int scanner_index = 0) {
    for (int i = 0; i < 10; ++i) {
      Observation& observation = state_.observations.emplace_back();
      observation.landmark_id = landmark_id;
      observation.scanner_index = scanner_index;
      const int64_t at_ns = NanosecondsFromSeconds(second + 0.05 * i);
      SegmentMeasurement measurement;
      measurement.node_times_ns = {at_ns, at_ns + 5'000'000, at_ns + 10'000'000};
      observation.first_point = first.cast<float>();
      observation.last_point = last.cast<float>();
      observation.end_ns = 10'000'000;
      observation.num_points = 60;
      observation.sigma_offset_m = 0.002F;
      observation.sigma_direction_rad = 0.002F;
      const Eigen::Vector2f middle = 0.5F * (observation.first_point + observation.last_point);
      const Eigen::Vector2f along =
          (observation.last_point - observation.first_point).normalized();
      observation.measurement = PackedSegment(measurement, {middle, along});
    }
  }

 private:
  Rig rig_;
  MapState state_{Trajectory(0, 125'000'000, Rigid3d()), {}, {}, 0, {}};
};

}  // namespace plumbline
