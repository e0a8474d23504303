#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/sensor/scan_line.h"
#include "core/util/time.h"

namespace plumbline {

// A straight piece of a scan line: the trace of a surface in the scan plane, scanner frame, m.
struct SampledSegment {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  Eigen::Vector2d end = Eigen::Vector2d::Zero();

  double length_m() const { return (end - start).norm(); }
  Eigen::Vector2d At(double share) const { return start + share * (end - start); }
};

// A scan line of the sample, as its segments.
struct SampledLine {
  int64_t stamp_ns = 0;
  double angle_min = 0.0;
  double angle_increment = 0.0;
  double time_increment_s = 0.0;
  std::vector<SampledSegment> segments;

  // The instant at which the beam towards a point was taken, without the rig's time offset.
  int64_t InstantAt(const Eigen::Vector2d& p_scanner) const;
};

// Segments the lines of one topic, whose ranges are metres, with the mapper's segmentation.
std::vector<SampledLine> SegmentSample(const std::vector<ScanLine>& lines,
                                       double range_noise_m);

// Returns the range at which a ray from the scanner meets the nearest segment, m; negative
// where it meets none. direction: unit vector.
double RangeAlong(const SampledLine& line, const Eigen::Vector2d& direction);

// Whether most segments of a line, by their middles, lie within distance_m where another line
// saw something: that the scanner has not moved in between, or moves along all that it sees.
bool SeesTheSame(const SampledLine& line, const SampledLine& other, double distance_m);

// The rate at which the range towards a point of line `index` changes, m/s, from the lines
// around it; NaN where they do not show it.
double RangeRate(const std::vector<SampledLine>& lines,
                 size_t index,
                 const Eigen::Vector2d& p_scanner);

}  // namespace plumbline
