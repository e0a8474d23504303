#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/util/time.h"

namespace plumbline {

// ScanLine is one revolution of one scanner as it stands in the recording. Beam i points along
// (cos a, sin a, 0), a = angle_min + i * angle_increment or (*angles)[i], in the scanner frame
// and was taken at stamp_ns + i * time_increment_s. Ranges in metres; no return is NaN,
// infinite, zero, negative or outside the scanner's limits (Scanner::IsValidRange).
struct ScanLine {
  int scanner_index = 0;          // position in Rig::scanners
  int64_t stamp_ns = 0;           // instant of beam 0, without Scanner::time_offset_s
  double angle_min = 0.0;         // rad
  double angle_increment = 0.0;   // rad; the mean where the angles are irregular
  double time_increment_s = 0.0;  // between neighbouring beams
  std::vector<float> ranges;      // m
  // Unit vectors along the beams, which the lines of a scanner share; BeamDirection() computes
  // a direction that is missing here from the beam's angle.
  std::shared_ptr<const std::vector<Eigen::Vector2d>> directions;
  // Angle of each beam, rad, going round one way; nullptr if the increment gives them.
  std::shared_ptr<const std::vector<double>> angles;

  int num_beams() const { return static_cast<int>(ranges.size()); }
  int64_t BeamTime(int beam) const {
    return stamp_ns + NanosecondsFromSeconds(beam * time_increment_s);
  }
  double BeamAngle(int beam) const {
    return angles == nullptr ? angle_min + beam * angle_increment : IrregularAngle(beam);
  }
  Eigen::Vector2d BeamDirection(int beam) const {
    const auto at = static_cast<size_t>(beam);  // huge below 0
    if (directions != nullptr && at < directions->size()) return (*directions)[at];
    const double angle = BeamAngle(beam);
    return {std::cos(angle), std::sin(angle)};
  }
  // Returns the number of beams from a beam to a direction, on the shorter way round; negative
  // where the direction comes before the beam.
  double BeamsTo(double angle, int beam) const {
    const double turn = std::remainder(angle - BeamAngle(beam), 2.0 * M_PI);
    return angles == nullptr ? turn / angle_increment : IrregularBeamsTo(turn, beam);
  }

 private:
  // Beyond the first and the last beam, the increment counts.
  double IrregularAngle(int beam) const;
  double IrregularBeamsTo(double turn, int beam) const;
};

}  // namespace plumbline
