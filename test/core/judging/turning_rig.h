#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/judging/sampled_line.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/util/time.h"
#include "test/testing/six_walls.h"

namespace plumbline {

// What a rig measures that walks to and fro in a room of six walls and looks about.
class TurningRig {
 public:
  static constexpr int64_t kStartNs = SixWalls::kStartNs;
  static constexpr double kDuration = 4.0;  // s
  static constexpr double kRate = 20.0;     // Hz
  static constexpr double kFloorHeight = SixWalls::kFloorHeight;
  static constexpr double kCeilingHeight = SixWalls::kCeilingHeight;

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
      const std::vector<ScanLine> scan =
          SixWalls::Take(SixWalls::Room(), rig_, stamp_ns, WorldFromBody, &random);
      for (size_t i = 0; i < lines.size(); ++i) lines[i].push_back(scan[i]);
    }
    return lines;
  }

  std::vector<std::vector<SampledLine>> TakeSample() {
    std::vector<std::vector<SampledLine>> sample;
    for (const std::vector<ScanLine>& lines : TakeLines()) {
      sample.push_back(SegmentSample(lines, SixWalls::kRangeNoise));
    }
    return sample;
  }

 private:
  Rig rig_;
};

}  // namespace plumbline
