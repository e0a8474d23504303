#include "core/map/observation.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/map/observation_poses.h"
#include "core/util/time.h"
#include "factors/segment/segment_measurement.h"
#include "factors/segment/segment_moments.h"

namespace plumbline {
namespace {

// A line in the scan plane: normal . p = distance.
struct ScanPlaneLine {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  double distance = 0.0;
};

// Calls visit(index, first, last) for the stretches of a segment's beams that count; index: of
// the first one among them all.
template <typename Visit>
void VisitStretches(const Segment& segment, const Visit& visit) {
  int index = 0;
  int first = segment.first_beam;
  const auto end_before = [&](int beam) {
    if (first < beam) visit(index, first, beam - 1);
    index += beam - first;
    first = beam + 1;
  };
  for (const int excluded : segment.excluded_beams) end_before(excluded);
  end_before(segment.last_beam + 1);
  CHECK_EQ(index, segment.num_points) << "segment and its beams disagree";
}

// The line nearest to the segment's points, each weighted by the angle at which its beam meets
// the segment's line.
ScanPlaneLine FitLine(const ScanLine& scan_line, const Segment& segment) {
  const Eigen::Vector2d origin = scan_line.ranges[static_cast<size_t>(segment.first_beam)] *
                                 scan_line.BeamDirection(segment.first_beam);
  const double origin_x = origin.x();
  const double origin_y = origin.y();
  const double normal_x = segment.normal.x();
  const double normal_y = segment.normal.y();
  double sum = 0.0, sum_x = 0.0, sum_y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  VisitStretches(segment, [&](int, int first, int last) {
    for (int beam = first; beam <= last; ++beam) {
      const Eigen::Vector2d direction = scan_line.BeamDirection(beam);
      const double range = scan_line.ranges[static_cast<size_t>(beam)];
      const double cosine = normal_x * direction.x() + normal_y * direction.y();
      const double weight = 1.0 / std::max(cosine * cosine, 1e-4);
      const double from_x = range * direction.x() - origin_x;
      const double from_y = range * direction.y() - origin_y;
      const double weighted_x = weight * from_x;
      const double weighted_y = weight * from_y;
      sum += weight;
      sum_x += weighted_x;
      sum_y += weighted_y;
      xx += weighted_x * from_x;
      xy += weighted_x * from_y;
      yy += weighted_y * from_y;
    }
  });
  const Eigen::Vector2d mean(sum_x / sum, sum_y / sum);
  xx -= sum_x * mean.x();
  xy -= sum_x * mean.y();
  yy -= sum_y * mean.y();
  // The direction of largest scatter, of the two the one nearer to the segment's.
  const double twice = std::atan2(2.0 * xy, xx - yy);
  ScanPlaneLine line;
  line.normal = {-std::sin(0.5 * twice), std::cos(0.5 * twice)};
  if (line.normal.dot(segment.normal) < 0.0) line.normal = -line.normal;
  line.distance = line.normal.dot(origin + mean);
  return line;
}

// The nodes of a segment: those of the whole scan line, as far as that lasts short enough, so
// that the poses there are computed once for all of its segments.
std::array<int64_t, 3> Nodes(const ScanLine& scan_line,
                             int64_t offset_ns,
                             int64_t start_ns,
                             int64_t end_ns) {
  const int64_t first_ns = scan_line.BeamTime(0) + offset_ns;
  const int64_t last_ns = scan_line.BeamTime(scan_line.num_beams() - 1) + offset_ns;
  return last_ns - first_ns <= kMaxQuadraticSpanNs ? NodesOfSpan(first_ns, last_ns)
                                                   : NodesOfSpan(start_ns, end_ns);
}

// Beams of a segment side by side, so that loops over them become vector instructions.
struct BeamBlock {
  using Values = SegmentMoments::Values;

  size_t size = 0;
  Values since_start;                   // beams since the segment's first
  Values x, y;                          // unit vector along the beam
  Values measured;                      // range
  Values normal_x, normal_y, distance;  // of the line that it is taken to
};

// Where a beam meets the line, given the cosine of the angle between beam and normal; the
// measured range where it runs along it.
double RangeAt(double distance, double cosine, double measured) {
  const double range = distance / cosine;
  // Both are asked: a branch would keep the compiler from taking several beams at a time.
  return (std::abs(cosine) > 1e-3) & (range > 0.0) ? range : measured;
}

// The sums over a segment's beams, each taken to its line.
class BeamSums {
 public:
  // points: where the single beams are kept; nullptr where they are not.
  BeamSums(const ScanLine& scan_line,
           const Scanner& scanner,
           int64_t start_ns,
           SegmentMoments* moments,
           std::vector<ObservedPoint>* points)
      : range_variance_(scanner.range_noise_m * scanner.range_noise_m),
        noise_growth_(scanner.range_noise_per_m2 * scanner.range_noise_per_m2),
        angle_variance_(scanner.angle_noise_rad * scanner.angle_noise_rad),
        increment_ns_(scan_line.time_increment_s * 1e9),
        start_ns_(start_ns),
        moments_(moments),
        points_(points) {}

  void Add(const BeamBlock& beams) {
    SegmentMoments::Points points;  // a local one: nothing else can lie in its place
    SegmentMoments::Values out_of_plane;
    for (size_t i = 0; i < beams.size; ++i) {
      const double x = beams.x[i];
      const double y = beams.y[i];
      const double cosine = beams.normal_x[i] * x + beams.normal_y[i] * y;
      const double sine = beams.normal_x[i] * y - beams.normal_y[i] * x;
      const double range = RangeAt(beams.distance[i], cosine, beams.measured[i]);
      const double range2 = range * range;
      const double range_variance = range_variance_ + noise_growth_ * (range2 * range2);
      const double across_variance = range2 * angle_variance_;
      const double weight =
          1.0 / (range_variance * cosine * cosine + across_variance * sine * sine);
      points.x[i] = range * x;
      points.y[i] = range * y;
      points.since_start_ns[i] = beams.since_start[i] * increment_ns_;
      points.weight[i] = weight;
      points.offset[i] = cosine * (beams.measured[i] - range);
      points.by_range[i] = cosine;
      out_of_plane[i] = across_variance * weight;
    }
    for (size_t i = 0; i < beams.size; ++i) out_of_plane_ += out_of_plane[i];
    moments_->Add(points, beams.size);
    if (points_ != nullptr) Keep(points, beams.size);
  }

  double out_of_plane() const { return out_of_plane_; }

 private:
  void Keep(const SegmentMoments::Points& points, size_t size) {
    for (size_t i = 0; i < size; ++i) {
      const double whitening = std::sqrt(points.weight[i]);
      points_->push_back({{points.x[i], points.y[i]},
                          start_ns_ + std::llround(points.since_start_ns[i]),
                          whitening,
                          whitening * points.offset[i]});
    }
  }

  double range_variance_;
  double noise_growth_;  // what the fourth power of the range adds, times this
  double angle_variance_;
  double increment_ns_;
  int64_t start_ns_;
  SegmentMoments* moments_;
  std::vector<ObservedPoint>* points_;
  double out_of_plane_ = 0.0;
};

// The beam in the middle of those of a segment that count.
int MiddleBeam(const Segment& segment) {
  int middle_beam = segment.first_beam;
  VisitStretches(segment, [&](int index, int first, int last) {
    const int middle = first + segment.num_points / 2 - index;
    if (middle >= first && middle <= last) middle_beam = middle;
  });
  return middle_beam;
}

// Calls visit(&beams) for the beams of a segment that count, block by block; the lines that
// they are taken to are left to visit.
template <typename Visit>
void VisitBlocks(const ScanLine& scan_line, const Segment& segment, const Visit& visit) {
  BeamBlock beams;
  VisitStretches(segment, [&](int, int first, int last) {
    for (int beam = first; beam <= last;) {
      const size_t begin = beams.size;
      const size_t count =
          std::min(static_cast<size_t>(last + 1 - beam), SegmentMoments::kBlock - begin);
      for (size_t i = begin; i < begin + count; ++i, ++beam) {
        const Eigen::Vector2d direction = scan_line.BeamDirection(beam);
        beams.since_start[i] = beam - segment.first_beam;
        beams.x[i] = direction.x();
        beams.y[i] = direction.y();
        beams.measured[i] = scan_line.ranges[static_cast<size_t>(beam)];
      }
      beams.size += count;
      if (beams.size < SegmentMoments::kBlock) continue;
      visit(&beams);
      beams.size = 0;
    }
  });
  if (beams.size > 0) visit(&beams);
}

// Compresses a segment of which set_lines(&beams) gives the lines that its beams are taken to;
// tangent and weights follow from them.
template <typename SetLines>
Observation ObserveBeams(const ScanLine& scan_line,
                         const Scanner& scanner,
                         const Segment& segment,
                         const SetLines& set_lines,
                         bool keep_points) {
  const int64_t offset_ns = NanosecondsFromSeconds(scanner.time_offset_s);
  const auto line_of = [&](int beam) {
    BeamBlock one;
    one.size = 1;
    one.since_start[0] = beam - segment.first_beam;
    const Eigen::Vector2d direction = scan_line.BeamDirection(beam);
    one.x[0] = direction.x();
    one.y[0] = direction.y();
    one.measured[0] = scan_line.ranges[static_cast<size_t>(beam)];
    set_lines(&one);
    return ScanPlaneLine{{one.normal_x[0], one.normal_y[0]}, one.distance[0]};
  };
  const auto point_of = [&](int beam) -> Eigen::Vector2d {
    const ScanPlaneLine line = line_of(beam);
    const Eigen::Vector2d direction = scan_line.BeamDirection(beam);
    const double measured = scan_line.ranges[static_cast<size_t>(beam)];
    return RangeAt(line.distance, line.normal.dot(direction), measured) * direction;
  };
  const Eigen::Vector2d start = point_of(segment.first_beam);
  const Eigen::Vector2d end = point_of(segment.last_beam);
  const int64_t start_time_ns = scan_line.BeamTime(segment.first_beam) + offset_ns;
  const int64_t end_time_ns = scan_line.BeamTime(segment.last_beam) + offset_ns;
  SegmentMoments moments(start, end, start_time_ns, end_time_ns);
  std::vector<ObservedPoint> points;
  BeamSums sums(scan_line, scanner, start_time_ns, &moments, keep_points ? &points : nullptr);
  VisitBlocks(scan_line, segment, [&](BeamBlock* beams) {
    set_lines(beams);
    sums.Add(*beams);
  });
  const Eigen::Vector2d normal = line_of(MiddleBeam(segment)).normal;
  const Eigen::Vector2d tangent(-normal.y(), normal.x());
  const std::array<int64_t, 3> nodes_ns =
      Nodes(scan_line, offset_ns, start_time_ns, end_time_ns);
  Observation observation;
  observation.measurement = PackedSegment(
      moments.Compress(nodes_ns), {moments.Centroid().cast<float>(), tangent.cast<float>()});
  observation.first_point = start.cast<float>();
  observation.last_point = end.cast<float>();
  // Within the nodes' span, which the measurement holds in 32 bits.
  observation.start_ns = static_cast<int32_t>(start_time_ns - nodes_ns[0]);
  observation.end_ns = static_cast<int32_t>(end_time_ns - nodes_ns[0]);
  observation.num_points = segment.num_points;
  observation.points = points;
  observation.out_of_plane_ratio =
      static_cast<float>(sums.out_of_plane() / segment.num_points);
  return observation;
}

void Describe(const Segment& segment, const ScanLine& scan_line, Observation* observation) {
  observation->scanner_index = scan_line.scanner_index;
  observation->first_beam = segment.first_beam;
  observation->last_beam = segment.last_beam;
  observation->excluded_beams = segment.excluded_beams;
  observation->sigma_offset_m = static_cast<float>(segment.sigma_offset_m);
  observation->sigma_direction_rad = static_cast<float>(segment.sigma_direction_rad);
}

}  // namespace

Observation MakeObservation(const ScanLine& scan_line,
                            const Scanner& scanner,
                            const Segment& segment,
                            bool keep_points) {
  const ScanPlaneLine line = FitLine(scan_line, segment);
  const auto set_lines = [&](BeamBlock* beams) {
    for (size_t i = 0; i < beams->size; ++i) {
      beams->normal_x[i] = line.normal.x();
      beams->normal_y[i] = line.normal.y();
      beams->distance[i] = line.distance;
    }
  };
  Observation observation = ObserveBeams(scan_line, scanner, segment, set_lines, keep_points);
  Describe(segment, scan_line, &observation);
  return observation;
}

Observation MakeObservationOn(const PlaneTrace& trace,
                              const ScanLine& scan_line,
                              const Scanner& scanner,
                              const Segment& segment,
                              bool keep_points) {
  const int64_t offset_ns = NanosecondsFromSeconds(scanner.time_offset_s);
  const PlaneTrace unit = trace.WithUnitNormal();
  const double first_share = static_cast<double>(scan_line.BeamTime(segment.first_beam) +
                                                 offset_ns - unit.middle_ns()) /
                             unit.half_span_ns();
  const double share_per_beam = scan_line.time_increment_s * 1e9 / unit.half_span_ns();
  const auto set = [&](int row, const BeamBlock& beams, BeamBlock::Values* values) {
    const auto [constant, linear, quadratic] = unit.Polynomial(row);
    for (size_t i = 0; i < beams.size; ++i) {
      const double share = first_share + beams.since_start[i] * share_per_beam;
      (*values)[i] = constant + share * (linear + share * quadratic);
    }
  };
  const auto set_lines = [&](BeamBlock* beams) {
    set(0, *beams, &beams->normal_x);
    set(1, *beams, &beams->normal_y);
    set(2, *beams, &beams->distance);
  };
  Observation observation = ObserveBeams(scan_line, scanner, segment, set_lines, keep_points);
  Describe(segment, scan_line, &observation);
  return observation;
}

void EndAtPoints(const ScanLine& scan_line, Observation* observation) {
  const Eigen::Vector2d tangent = observation->tangent();
  // outwards: along the tangent, 1 or -1.
  const auto move = [&](int beam, double outwards, Eigen::Vector2f* end) {
    const Eigen::Vector2d measured =
        scan_line.ranges[static_cast<size_t>(beam)] * scan_line.BeamDirection(beam);
    const double to_foot = tangent.dot(measured - end->cast<double>());
    if (outwards * to_foot < 0.0) *end += (to_foot * tangent).cast<float>();
  };
  const double along = tangent.dot(observation->end() - observation->start());
  const double outwards = along < 0.0 ? -1.0 : 1.0;
  move(observation->first_beam, -outwards, &observation->first_point);
  move(observation->last_beam, outwards, &observation->last_point);
}

std::optional<double> RangeOnCylinder(const Landmark& cylinder,
                                      const ScanPlacement& placement,
                                      const Eigen::Vector2d& direction) {
  const Eigen::Vector3d along = placement.leftCols<2>() * direction;
  const Eigen::Vector3d scanner_world = placement.col(2);
  // height + slope r + bow r^2 = 0
  const double height = cylinder.SignedDistance(scanner_world);
  const double slope = cylinder.NormalNear(scanner_world).dot(along);
  const double bow = 0.5 * cylinder.Curvature() * along.head<2>().squaredNorm();
  const double root2 = slope * slope - 4.0 * bow * height;
  if (!(root2 > 0.0)) return std::nullopt;
  const double range = 2.0 * height / (std::sqrt(root2) - slope);
  return range > 0.0 ? std::make_optional(range) : std::nullopt;
}

Observation MakeObservationOnArc(const Landmark& cylinder,
                                 const ScanMotion& motion,
                                 const ScanLine& scan_line,
                                 const Scanner& scanner,
                                 const Segment& segment,
                                 bool keep_points) {
  const int64_t first_ns =
      scan_line.BeamTime(segment.first_beam) + NanosecondsFromSeconds(scanner.time_offset_s);
  constexpr double kMaxOffArc = 0.3;  // m
  const double bend = 0.5 * cylinder.Curvature();
  std::optional<SegmentFrame> frame;
  const auto set_line = [&](size_t i, BeamBlock* beams) {
    const ScanPlacement placement = motion.At(
        first_ns + std::llround(beams->since_start[i] * scan_line.time_increment_s * 1e9));
    const Eigen::Vector2d direction(beams->x[i], beams->y[i]);
    double range = beams->measured[i];
    // A beam that runs along the arc meets it anywhere.
    const std::optional<double> met = RangeOnCylinder(cylinder, placement, direction);
    if (met && std::abs(*met - range) < kMaxOffArc) range = *met;
    const Eigen::Vector3d at =
        placement.col(2) + range * (placement.leftCols<2>() * direction);
    const Eigen::Vector2d in_plane =
        placement.leftCols<2>().transpose() * cylinder.NormalNear(at);
    const double cut = in_plane.norm();
    const Eigen::Vector2d normal = in_plane / cut;
    beams->normal_x[i] = normal.x();
    beams->normal_y[i] = normal.y();
    beams->distance[i] = range * normal.dot(direction);
    // A compressed segment bows along its tangent alone. What the arc's bow is beyond that
    // goes into the offsets.
    if (!frame) return;
    const Eigen::Vector2d from_centroid = range * direction - frame->origin.cast<double>();
    const double along = frame->tangent.cast<double>().dot(from_centroid);
    const double level2 =
        (placement.leftCols<2>() * frame->tangent.cast<double>()).head<2>().squaredNorm();
    const double from_centroid2 =
        (placement.leftCols<2>() * from_centroid).head<2>().squaredNorm();
    beams->measured[i] +=
        bend * (from_centroid2 - along * along * level2) / (cut * normal.dot(direction));
  };
  const auto set_lines = [&](BeamBlock* beams) {
    for (size_t i = 0; i < beams->size; ++i) set_line(i, beams);
  };
  frame = ObserveBeams(scan_line, scanner, segment, set_lines, false).measurement.frame();
  Observation observation = ObserveBeams(scan_line, scanner, segment, set_lines, keep_points);
  Describe(segment, scan_line, &observation);
  return observation;
}

SegmentWeights WeightsOn(const Observation& observation,
                         const Eigen::Quaterniond& world_from_scanner,
                         const Eigen::Vector3d& normal_world) {
  const Eigen::Vector3d normal_scanner = world_from_scanner.conjugate() * normal_world;
  const double across = normal_scanner.z() * normal_scanner.z();
  const double along = 1.0 - across;
  const double scale = 1.0 / std::sqrt(along + observation.out_of_plane_ratio * across);
  return {scale, scale * std::sqrt(std::max(0.0, along))};
}

}  // namespace plumbline
