#include "core/judging/sampled_line.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/judging/levels.h"
#include "core/segmentation/segmentation.h"

namespace plumbline {
namespace {

constexpr double kMinLength = 0.2;  // m, of a segment worth keeping
constexpr double kRateSpan = 0.3;   // s, before and after, in which a rate is constant
constexpr int kMaxNeighbours = 4;   // lines before and after

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

int64_t SampledLine::InstantAt(const Eigen::Vector2d& p_scanner) const {
  const double turn = 2.0 * M_PI;
  double angle = std::atan2(p_scanner.y(), p_scanner.x()) - angle_min;
  if (angle_increment < 0.0) angle = -angle;
  angle -= turn * std::floor(angle / turn);
  const double beam = angle / std::abs(angle_increment);
  return stamp_ns + NanosecondsFromSeconds(beam * time_increment_s);
}

std::vector<SampledLine> SegmentSample(const std::vector<ScanLine>& lines,
                                       double range_noise_m) {
  Scanner scanner;
  scanner.range_noise_m = range_noise_m;
  scanner.min_range_m = 1e-3;
  scanner.max_range_m = std::numeric_limits<float>::max();
  std::vector<SampledLine> sampled;
  sampled.reserve(lines.size());
  for (const ScanLine& line : lines) {
    SampledLine one;
    one.stamp_ns = line.stamp_ns;
    one.angle_min = line.angle_min;
    one.angle_increment = line.angle_increment;
    one.time_increment_s = line.time_increment_s;
    for (const Segment& segment : SegmentScanLine(line, scanner, {}, {})) {
      if (segment.length_m() < kMinLength) continue;
      one.segments.push_back({segment.start, segment.end});
    }
    sampled.push_back(std::move(one));
  }
  return sampled;
}

double RangeAlong(const SampledLine& line, const Eigen::Vector2d& direction) {
  double nearest = -1.0;
  for (const SampledSegment& segment : line.segments) {
    const double at_start = Cross(direction, segment.start);
    const double at_end = Cross(direction, segment.end);
    if ((at_start > 0.0) == (at_end > 0.0)) continue;
    const double range = direction.dot(segment.At(at_start / (at_start - at_end)));
    if (range > 0.0 && (nearest < 0.0 || range < nearest)) nearest = range;
  }
  return nearest;
}

bool SeesTheSame(const SampledLine& line, const SampledLine& other, double distance_m) {
  size_t num_same = 0;
  for (const SampledSegment& segment : line.segments) {
    const Eigen::Vector2d middle = segment.At(0.5);
    const double range = RangeAlong(other, middle.normalized());
    if (range >= 0.0 && std::abs(range - middle.norm()) < distance_m) ++num_same;
  }
  return 2 * num_same > line.segments.size();
}

double RangeRate(const std::vector<SampledLine>& lines,
                 size_t index,
                 const Eigen::Vector2d& p_scanner) {
  const double range = p_scanner.norm();
  const Eigen::Vector2d direction = p_scanner / range;
  double sum_t = 0.0, sum_r = 0.0, sum_tt = 0.0, sum_tr = 0.0;
  int num = 0;
  bool is_seen_before = false;
  bool is_seen_after = false;
  for (int step = -kMaxNeighbours; step <= kMaxNeighbours; ++step) {
    const auto at = static_cast<std::ptrdiff_t>(index) + step;
    if (at < 0 || at >= static_cast<std::ptrdiff_t>(lines.size())) continue;
    const SampledLine& line = lines[static_cast<size_t>(at)];
    const double time_s = SecondsBetween(lines[index].stamp_ns, line.stamp_ns);
    if (std::abs(time_s) > kRateSpan) continue;
    const double seen = RangeAlong(line, direction);
    if (seen < 0.0 || std::abs(seen - range) > kOtherSurface) continue;
    is_seen_before = is_seen_before || step < 0;
    is_seen_after = is_seen_after || step > 0;
    ++num;
    sum_t += time_s;
    sum_r += seen;
    sum_tt += time_s * time_s;
    sum_tr += time_s * seen;
  }
  if (!is_seen_before || !is_seen_after) return std::numeric_limits<double>::quiet_NaN();
  const double spread = sum_tt - sum_t * sum_t / num;
  return (sum_tr - sum_t * sum_r / num) / spread;
}

}  // namespace plumbline
