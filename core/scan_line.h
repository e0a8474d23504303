#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/time.h"

namespace plumbline {

// One revolution of one scanner as it stands in the recording. Beam i points along
// (cos a, sin a, 0), a = angle_min + i * angle_increment, in the scanner frame and was taken
// at stamp_ns + i * time_increment_s. Ranges in metres; no return is NaN, infinite, zero,
// negative or outside the scanner's limits (Scanner::IsValidRange).
struct ScanLine {
  int scanner_index = 0;          // position in Rig::scanners
  int64_t stamp_ns = 0;           // instant of beam 0, without Scanner::time_offset_s
  double angle_min = 0.0;         // rad
  double angle_increment = 0.0;   // rad
  double time_increment_s = 0.0;  // between neighbouring beams
  std::vector<float> ranges;      // m

  int num_beams() const { return static_cast<int>(ranges.size()); }
  int64_t BeamTime(int beam) const {
    return stamp_ns + NanosecondsFromSeconds(beam * time_increment_s);
  }
  double BeamAngle(int beam) const { return angle_min + beam * angle_increment; }
  Eigen::Vector2d BeamDirection(int beam) const {
    const double angle = BeamAngle(beam);
    return {std::cos(angle), std::sin(angle)};
  }
};

// Directions of one beam after the other, each that of the beam before turned on: exact to
// 1e-13 after thousands of beams. step -1: backwards.
class BeamSweep {
 public:
  BeamSweep(const ScanLine& scan_line, int first_beam, int step = 1)
      : direction_(scan_line.BeamDirection(first_beam)),
        cosine_(std::cos(scan_line.angle_increment)),
        sine_(step * std::sin(scan_line.angle_increment)) {}

  const Eigen::Vector2d& direction() const { return direction_; }
  void Next() {
    // As one vector: numbers written one by one and then read together are what a processor
    // has to wait for.
    const Eigen::Vector2d across(-direction_.y(), direction_.x());
    direction_ = cosine_ * direction_ + sine_ * across;
  }

 private:
  Eigen::Vector2d direction_;
  double cosine_;
  double sine_;
};

}  // namespace plumbline
