#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "core/check/sampled_line.h"
#include "core/geometry/rigid3.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/util/time.h"
#include "test/testing/plane_scene.h"

namespace plumbline {

// What a rig measures that walks to and fro in a room of six walls, no two of them alike, and
// looks about. Noise of 1 cm.
class TurningRig {
 public:
  static constexpr int64_t kStartNs = 1'600'000'000'000'000'000;
  static constexpr double kDuration = 4.0;  // s
  static constexpr double kRate = 20.0;     // Hz
  static constexpr double kNoise = 0.01;    // m
  static constexpr double kFloorHeight = -1.2;
  static constexpr double kCeilingHeight = 1.5;

  // The rig as it is; what a rig file says of it is the test's business.
  explicit TurningRig(const Rig& rig) : rig_(rig) {
    for (Scanner& scanner : rig_.scanners) scanner.scan_rate_hz = kRate;
  }

  static Rigid3d WorldFromBody(int64_t time_ns) {
    const double t = SecondsBetween(kStartNs, time_ns);
    return {RotationFromRollPitchYaw(0.0, 0.0, 1.0 * std::sin(0.8 * t)),
            Eigen::Vector3d(0.7 * std::sin(1.0 * t), 0.5 * std::sin(1.3 * t), 0.0)};
  }

  // By scanner.
  std::vector<std::vector<ScanLine>> TakeLines() {
    std::vector<std::vector<ScanLine>> lines(rig_.scanners.size());
    std::mt19937_64 random(1);
    for (int k = 0; k < static_cast<int>(kRate * kDuration); ++k) {
      const int64_t stamp_ns = kStartNs + NanosecondsFromSeconds(k / kRate);
      for (size_t i = 0; i < lines.size(); ++i) {
        lines[i].push_back(TakeScanLine(Room(),
                                        rig_.scanners[i],
                                        static_cast<int>(i),
                                        stamp_ns,
                                        WorldFromBody,
                                        kNoise,
                                        &random));
      }
    }
    return lines;
  }

  std::vector<std::vector<SampledLine>> TakeSample() {
    std::vector<std::vector<SampledLine>> sample;
    for (const std::vector<ScanLine>& lines : TakeLines()) {
      sample.push_back(SegmentSample(lines, kNoise));
    }
    return sample;
  }

 private:
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

  Rig rig_;
};

}  // namespace plumbline
