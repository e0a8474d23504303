#include "core/judging/view_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <utility>

#include "core/judging/levels.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

// Scan planes that are turned by less against each other count as parallel.
// Traces that cross at a smaller angle do not show how their plane stands.
constexpr double kMinCrossing = 0.2;
constexpr double kMinTimeApart =
    0.02;  // s; lines farther apart than a period see other places

// One scanner's sample under what is assumed of it.
class View {
 public:
  View(const std::vector<SampledLine>& lines, const MountedScanner& scanner)
      : lines_(lines), scanner_(scanner) {}

  const std::vector<SampledLine>& lines() const { return lines_; }
  const Eigen::Vector3d& origin() const { return scanner_.body_from_scanner.translation; }
  Eigen::Vector3d plane_normal() const {
    return scanner_.body_from_scanner.rotation * Eigen::Vector3d::UnitZ();
  }
  Eigen::Vector3d ToBody(const Eigen::Vector2d& p_scanner) const {
    const double range = p_scanner.norm();
    const double longer = range > 0.0 ? 1.0 + scanner_.range_offset_m / range : 1.0;
    return scanner_.body_from_scanner * Flat(longer * p_scanner);
  }
  Eigen::Vector3d Turn(const Eigen::Vector2d& direction) const {
    return scanner_.body_from_scanner.rotation * Flat(direction).normalized();
  }
  // The place in the scanner's own data of a point of its plane.
  Eigen::Vector2d FromBody(const Eigen::Vector3d& p_body) const {
    const Eigen::Vector3d p = scanner_.body_from_scanner.Inverse() * p_body;
    return Eigen::Vector2d(p.x(), scanner_.mirrored ? -p.y() : p.y()) / scanner_.scale;
  }
  int64_t Instant(const SampledLine& line, const Eigen::Vector2d& p_scanner) const {
    return line.InstantAt(p_scanner) + NanosecondsFromSeconds(scanner_.time_offset_s);
  }
  int64_t Stamp(size_t index) const {
    return lines_[index].stamp_ns + NanosecondsFromSeconds(scanner_.time_offset_s);
  }
  // Velocity of the surface point along the beam, body frame, m/s.
  Eigen::Vector3d Velocity(size_t index, const Eigen::Vector2d& p_scanner) const {
    const double rate = RangeRate(lines_, index, p_scanner) * scanner_.scale;
    return std::isfinite(rate) ? Eigen::Vector3d(rate * Turn(p_scanner))
                               : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }
  // The line nearest to an instant; nothing where none is near.
  std::optional<size_t> LineNear(int64_t instant_ns) const {
    if (lines_.empty()) return std::nullopt;
    const int64_t stamp_ns = instant_ns - NanosecondsFromSeconds(scanner_.time_offset_s);
    const auto after = std::lower_bound(
        lines_.begin(), lines_.end(), stamp_ns, [](const SampledLine& line, int64_t stamp) {
          return line.stamp_ns < stamp;
        });
    auto index = static_cast<size_t>(after - lines_.begin());
    if (index == lines_.size() ||
        (index > 0 && stamp_ns - lines_[index - 1].stamp_ns < after->stamp_ns - stamp_ns)) {
      --index;
    }
    const double apart_s = std::abs(SecondsBetween(lines_[index].stamp_ns, stamp_ns));
    const double period_s =
        index > 0 ? SecondsBetween(lines_[index - 1].stamp_ns, lines_[index].stamp_ns) : 0.0;
    if (apart_s > std::max(kMinTimeApart, std::min(0.6 * period_s, 0.15))) return std::nullopt;
    return index;
  }

 private:
  Eigen::Vector3d Flat(const Eigen::Vector2d& p) const {
    return scanner_.scale * Eigen::Vector3d(p.x(), scanner_.mirrored ? -p.y() : p.y(), 0.0);
  }

  const std::vector<SampledLine>& lines_;
  const MountedScanner& scanner_;
};

// The point at which a trace of a scanner crosses the other's scan plane.
struct Crossing {
  Eigen::Vector2d p_scanner;
  Eigen::Vector3d p_body;
  Eigen::Vector3d direction_body;  // of the trace
};

// The nearest crossings on both sides, along the line in which the scan planes meet.
std::array<std::optional<Crossing>, 2> CrossingsOf(const View& view,
                                                   const SampledLine& line,
                                                   const View& other,
                                                   const Eigen::Vector3d& along) {
  std::array<std::optional<Crossing>, 2> nearest;
  std::array<double, 2> distances = {1e9, 1e9};
  const Eigen::Vector3d normal = other.plane_normal();
  for (const SampledSegment& segment : line.segments) {
    const Eigen::Vector3d start = view.ToBody(segment.start);
    const Eigen::Vector3d end = view.ToBody(segment.end);
    const double at_start = normal.dot(start - other.origin());
    const double at_end = normal.dot(end - other.origin());
    if ((at_start > 0.0) == (at_end > 0.0)) continue;
    const double share = at_start / (at_start - at_end);
    const Eigen::Vector3d p_body = start + share * (end - start);
    const double from_scanner = along.dot(p_body - view.origin());
    const size_t side = from_scanner > 0.0 ? 1 : 0;
    if (std::abs(from_scanner) >= distances[side]) continue;
    distances[side] = std::abs(from_scanner);
    nearest[side] = Crossing{segment.At(share), p_body, (end - start).normalized()};
  }
  return nearest;
}

// Compares the views of two scanners line by line.
class ViewComparer {
 public:
  ViewComparer(const View& a, const View& b, std::vector<ViewComparison>* comparisons)
      : a_(a), b_(b), comparisons_(comparisons) {
    along_ = a.plane_normal().cross(b.plane_normal());
    is_parallel_ = along_.norm() < std::sin(kParallelAngle);
    if (!is_parallel_) along_.normalize();
  }

  void Compare(size_t index_a, size_t index_b) {
    if (is_parallel_) {
      CompareWalls(a_, index_a, b_, index_b, 1.0);
      CompareWalls(b_, index_b, a_, index_a, -1.0);
    } else {
      CompareCrossings(index_a, index_b);
    }
  }

 private:
  void CompareCrossings(size_t index_a, size_t index_b) {
    const SampledLine& line_a = a_.lines()[index_a];
    const SampledLine& line_b = b_.lines()[index_b];
    const auto crossings_a = CrossingsOf(a_, line_a, b_, along_);
    const auto crossings_b = CrossingsOf(b_, line_b, a_, along_);
    for (size_t side = 0; side < 2; ++side) {
      if (!crossings_a[side] || !crossings_b[side]) continue;
      const Crossing& at_a = *crossings_a[side];
      const Crossing& at_b = *crossings_b[side];
      const Eigen::Vector3d normal = at_a.direction_body.cross(at_b.direction_body);
      if (normal.norm() < kMinCrossing) continue;
      Add(normal.normalized(),
          at_a.p_body,
          at_b.p_body,
          0.5 * (a_.Velocity(index_a, at_a.p_scanner) + b_.Velocity(index_b, at_b.p_scanner)),
          SecondsBetween(b_.Instant(line_b, at_b.p_scanner),
                         a_.Instant(line_a, at_a.p_scanner)));
    }
  }

  // Points of `from` against what `onto` sees in their directions. sign: 1 where `onto` is a.
  void CompareWalls(
      const View& onto, size_t index, const View& from, size_t index_from, double sign) {
    const SampledLine& line = onto.lines()[index];
    const SampledLine& line_from = from.lines()[index_from];
    const double apart = (onto.origin() - from.origin()).norm();
    for (const SampledSegment& segment : line_from.segments) {
      if (segment.length_m() < kMinTrace) continue;
      for (const double share : {0.25, 0.75}) {
        const Eigen::Vector2d p_from = segment.At(share);
        const Eigen::Vector2d p = onto.FromBody(from.ToBody(p_from));
        if (p.norm() < 0.1) continue;
        const double range = RangeAlong(line, p.normalized());
        if (range < 0.0) continue;
        if (apart > kOtherSurface && p.norm() > range + kOtherSurface) continue;
        const Eigen::Vector2d p_onto = range * p.normalized();
        // The surface's direction is that of the trace from which the point is.
        const Eigen::Vector3d trace = from.Turn(segment.end - segment.start);
        const Eigen::Vector3d normal = trace.cross(onto.plane_normal()).normalized();
        const double time_s =
            SecondsBetween(from.Instant(line_from, p_from), onto.Instant(line, p_onto));
        const Eigen::Vector3d velocity =
            0.5 * (onto.Velocity(index, p_onto) + from.Velocity(index_from, p_from));
        // Nothing is compared out of the plane.
        Eigen::Vector3d there = from.ToBody(p_from);
        const Eigen::Vector3d here = onto.ToBody(p_onto);
        there += onto.plane_normal() * onto.plane_normal().dot(here - there);
        if (sign > 0.0) {
          Add(normal, here, there, velocity, time_s);
        } else {
          Add(normal, there, here, velocity, -time_s);
        }
      }
    }
  }

  // time_s: from the instant of b to that of a.
  void Add(const Eigen::Vector3d& normal,
           const Eigen::Vector3d& p_a,
           const Eigen::Vector3d& p_b,
           const Eigen::Vector3d& velocity,
           double time_s) {
    ViewComparison comparison;
    comparison.normal = normal;
    comparison.p_a = p_a;
    comparison.p_b = p_b + time_s * velocity;
    comparison.rate_m_s = normal.dot(velocity);
    comparison.distance_m = normal.dot(comparison.p_a - comparison.p_b);
    comparisons_->push_back(comparison);
  }

  const View& a_;
  const View& b_;
  std::vector<ViewComparison>* comparisons_;
  Eigen::Vector3d along_;
  bool is_parallel_ = false;
};

}  // namespace

MountedRig AsRigFileSays(const Rig& rig, const std::vector<size_t>& sources) {
  MountedRig mounted;
  for (size_t i = 0; i < rig.scanners.size(); ++i) {
    const Scanner& scanner = rig.scanners[i];
    mounted.push_back({sources[i],
                       scanner.body_from_scanner,
                       false,
                       scanner.range_scale,
                       scanner.time_offset_s,
                       -scanner.range_bias_m});
  }
  return mounted;
}

std::vector<ViewComparison> CompareViews(const std::vector<std::vector<SampledLine>>& sample,
                                         const MountedRig& rig,
                                         size_t a,
                                         size_t b,
                                         int max_lines,
                                         double min_motion_m) {
  std::vector<ViewComparison> comparisons;
  const View view_a(sample[rig[a].source], rig[a]);
  const View view_b(sample[rig[b].source], rig[b]);
  ViewComparer comparer(view_a, view_b, &comparisons);
  const size_t num_lines = view_a.lines().size();
  const size_t stride = std::max<size_t>(1, num_lines / static_cast<size_t>(max_lines));
  std::optional<std::pair<size_t, size_t>> before;
  for (size_t i = stride / 2; i < num_lines; i += stride) {
    const std::optional<size_t> near = view_b.LineNear(view_a.Stamp(i));
    if (!near) continue;
    if (min_motion_m > 0.0 && before &&
        SeesTheSame(view_a.lines()[i], view_a.lines()[before->first], min_motion_m) &&
        SeesTheSame(view_b.lines()[*near], view_b.lines()[before->second], min_motion_m)) {
      continue;
    }
    comparer.Compare(i, *near);
    before = {i, *near};
  }
  return comparisons;
}

double MedianDistance(const std::vector<ViewComparison>& comparisons) {
  std::vector<double> sizes;
  for (const ViewComparison& one : comparisons) sizes.push_back(std::abs(one.distance_m));
  return Median(std::move(sizes));
}

double ShareWithin(const std::vector<ViewComparison>& comparisons, double distance_m) {
  if (comparisons.empty()) return 0.0;
  const auto num = std::count_if(
      comparisons.begin(), comparisons.end(), [distance_m](const ViewComparison& one) {
        return std::abs(one.distance_m) < distance_m;
      });
  return static_cast<double>(num) / static_cast<double>(comparisons.size());
}

}  // namespace plumbline
