#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "test/testing/plane_scene.h"

namespace plumbline {

// A room of six walls, no two of them alike, with floor and ceiling; test rigs walk through it
// from kStartNs on, their bodies at height 0.
struct SixWalls {
  static constexpr int64_t kStartNs = 1'600'000'000'000'000'000;
  static constexpr double kFloorHeight = -1.2;   // m
  static constexpr double kCeilingHeight = 1.5;  // m
  static constexpr double kRangeNoise = 0.01;    // m

  static PlaneScene Room() {
    constexpr double kDegree = M_PI / 180.0;
    return MakeRoom({{0.0, 2.5},
                     {65.0 * kDegree, 3.0},
                     {125.0 * kDegree, 2.2},
                     {190.0 * kDegree, 3.5},
                     {245.0 * kDegree, 2.7},
                     {300.0 * kDegree, 3.2}},
                    kFloorHeight,
                    kCeilingHeight);
  }

  // One scan line of each scanner of a rig, with noise. world_from_body(time_ns): its pose.
  template <typename Pose>
  static std::vector<ScanLine> Take(const PlaneScene& room,
                                    const Rig& rig,
                                    int64_t stamp_ns,
                                    const Pose& world_from_body,
                                    std::mt19937_64* random) {
    std::vector<ScanLine> lines;
    for (size_t i = 0; i < rig.scanners.size(); ++i) {
      lines.push_back(TakeScanLine(room,
                                   rig.scanners[i],
                                   static_cast<int>(i),
                                   stamp_ns,
                                   world_from_body,
                                   kRangeNoise,
                                   random));
    }
    return lines;
  }
};

}  // namespace plumbline
