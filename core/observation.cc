#include "core/observation.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/time.h"

namespace plumbline {
namespace {

// normal . p = distance
struct Line {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  double distance = 0.0;

  // Where the beam meets the line; the measured range where it runs along it.
  double RangeAlong(const Eigen::Vector2d& direction, double measured) const {
    const double cosine = normal.dot(direction);
    const double range = distance / cosine;
    return std::abs(cosine) > 1e-3 && range > 0.0 ? range : measured;
  }
};

// The line nearest to the points, each weighted by the slant at which its beam meets the line
// whose normal is given.
Line FitLine(const Eigen::Matrix2Xd& directions,
             const Eigen::VectorXd& ranges,
             const Eigen::Vector2d& normal) {
  const Eigen::ArrayXd weights =
      (directions.transpose() * normal).array().square().max(1e-4).inverse();
  const Eigen::Matrix2Xd points = directions * ranges.asDiagonal();
  const Eigen::Vector2d centroid = points * weights.matrix() / weights.sum();
  const Eigen::Matrix2Xd centred = points.colwise() - centroid;
  const Eigen::Matrix2d scatter =
      centred * weights.matrix().asDiagonal() * centred.transpose();
  // The direction of largest scatter, of the two the one nearer to the given line's.
  const double twice = std::atan2(2.0 * scatter(0, 1), scatter(0, 0) - scatter(1, 1));
  Line line;
  line.normal = {-std::sin(0.5 * twice), std::cos(0.5 * twice)};
  if (line.normal.dot(normal) < 0.0) line.normal = -line.normal;
  line.distance = line.normal.dot(centroid);
  return line;
}

// The beams of a segment that count.
struct Beams {
  Eigen::Matrix2Xd directions;
  Eigen::VectorXd ranges;
  std::vector<int64_t> times_ns;  // the scanner's time offset included
};

Beams BeamsOf(const ScanLine& scan_line, const Scanner& scanner, const Segment& segment) {
  const int64_t offset_ns = NanosecondsFromSeconds(scanner.time_offset_s);
  const Eigen::Index num_points = segment.num_points;
  Beams beams{Eigen::Matrix2Xd(2, num_points), Eigen::VectorXd(num_points), {}};
  Eigen::Index next = 0;
  auto excluded = segment.excluded_beams.begin();
  for (int beam = segment.first_beam; beam <= segment.last_beam; ++beam) {
    if (excluded != segment.excluded_beams.end() && *excluded == beam) {
      ++excluded;
      continue;
    }
    CHECK_LT(next, num_points) << "segment and its beams disagree";
    beams.directions.col(next) = scan_line.BeamDirection(beam);
    beams.ranges[next] = scan_line.ranges[static_cast<size_t>(beam)];
    beams.times_ns.push_back(scan_line.BeamTime(beam) + offset_ns);
    ++next;
  }
  CHECK_EQ(next, num_points) << "segment and its beams disagree";
  return beams;
}

// Up to this duration all segments of a scan line share its nodes, so that the poses there are
// computed once. What a quadratic misses of the motion grows with the span's third power: for
// 20 ms and a jerk of 100 rad/s^3 it is 0.007 mrad.
constexpr int64_t kMaxSharedSpanNs = 25'000'000;

std::array<int64_t, 3> Nodes(const ScanLine& scan_line,
                             const Scanner& scanner,
                             const Beams& beams) {
  const int64_t offset_ns = NanosecondsFromSeconds(scanner.time_offset_s);
  const int64_t first_ns = scan_line.BeamTime(0) + offset_ns;
  const int64_t last_ns = scan_line.BeamTime(scan_line.num_beams() - 1) + offset_ns;
  return last_ns - first_ns <= kMaxSharedSpanNs
             ? NodesOfSpan(first_ns, last_ns)
             : NodesOfSpan(beams.times_ns.front(), beams.times_ns.back());
}

// What MakeObservation and its variant have in common: lines[i] is the one that beam i is
// taken to, tangent and weights follow from them.
Observation ObserveBeams(const Beams& beams,
                         const std::vector<Line>& lines,
                         const Scanner& scanner,
                         const std::array<int64_t, 3>& nodes_ns,
                         bool keep_points) {
  const auto num_points = static_cast<Eigen::Index>(lines.size());
  const Line& middle = lines[lines.size() / 2];
  const Eigen::Vector2d tangent(-middle.normal.y(), middle.normal.x());
  const double range_variance = scanner.range_noise_m * scanner.range_noise_m;
  const double angle_variance = scanner.angle_noise_rad * scanner.angle_noise_rad;
  Eigen::Matrix2Xd points(2, num_points);  // on the lines
  Eigen::VectorXd whitening(num_points);
  Eigen::VectorXd offsets(num_points);
  double sum_weights = 0.0;
  double out_of_plane = 0.0;
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const Line& line = lines[static_cast<size_t>(i)];
    const Eigen::Vector2d direction = beams.directions.col(i);
    const double cosine = line.normal.dot(direction);
    const double sine = line.normal.x() * direction.y() - line.normal.y() * direction.x();
    const double range = line.RangeAlong(direction, beams.ranges[i]);
    const double across_variance = range * range * angle_variance;
    const double variance = range_variance * cosine * cosine + across_variance * sine * sine;
    points.col(i) = range * direction;
    whitening[i] = 1.0 / std::sqrt(variance);
    offsets[i] = whitening[i] * cosine * (beams.ranges[i] - range);
    centroid += points.col(i) / variance;
    sum_weights += 1.0 / variance;
    out_of_plane += across_variance / variance;
  }
  Observation observation;
  observation.num_points = static_cast<int>(num_points);
  observation.centroid = centroid / sum_weights;
  observation.tangent = tangent;
  observation.out_of_plane_ratio = out_of_plane / static_cast<double>(num_points);
  observation.start = points.col(0);
  observation.end = points.col(num_points - 1);
  observation.start_time_ns = beams.times_ns.front();
  observation.end_time_ns = beams.times_ns.back();
  observation.measurement =
      CompressSegment(points, beams.times_ns, whitening, offsets, nodes_ns);
  if (keep_points) {
    for (Eigen::Index i = 0; i < num_points; ++i) {
      observation.points.push_back(points.col(i));
      observation.point_whitening.push_back(whitening[i]);
      observation.point_offsets.push_back(offsets[i]);
    }
    observation.point_times_ns = beams.times_ns;
  }
  return observation;
}

void Describe(const Segment& segment, const ScanLine& scan_line, Observation* observation) {
  observation->scanner_index = scan_line.scanner_index;
  observation->first_beam = segment.first_beam;
  observation->last_beam = segment.last_beam;
  observation->excluded_beams = segment.excluded_beams;
  observation->sigma_offset_m = segment.sigma_offset_m;
  observation->sigma_direction_rad = segment.sigma_direction_rad;
}

}  // namespace

Observation MakeObservation(const ScanLine& scan_line,
                            const Scanner& scanner,
                            const Segment& segment,
                            bool keep_points) {
  const Beams beams = BeamsOf(scan_line, scanner, segment);
  const std::vector<Line> lines(beams.times_ns.size(),
                                FitLine(beams.directions, beams.ranges, segment.normal));
  Observation observation =
      ObserveBeams(beams, lines, scanner, Nodes(scan_line, scanner, beams), keep_points);
  Describe(segment, scan_line, &observation);
  return observation;
}

Observation MakeObservationOn(const PlaneTrace& trace,
                              const ScanLine& scan_line,
                              const Scanner& scanner,
                              const Segment& segment,
                              bool keep_points) {
  const Beams beams = BeamsOf(scan_line, scanner, segment);
  std::vector<Line> lines;
  lines.reserve(beams.times_ns.size());
  for (const int64_t time_ns : beams.times_ns) {
    const Eigen::Vector3d at = trace.At(time_ns);
    const double length = at.head<2>().norm();
    lines.push_back({at.head<2>() / length, at.z() / length});
  }
  Observation observation =
      ObserveBeams(beams, lines, scanner, Nodes(scan_line, scanner, beams), keep_points);
  Describe(segment, scan_line, &observation);
  return observation;
}

PlaneTrace::PlaneTrace(const std::array<int64_t, 3>& times_ns,
                       const std::array<Rigid3d, 3>& world_from_scanner,
                       const Eigen::Vector3d& normal_world,
                       double distance)
    : middle_ns_(times_ns[1]),
      half_span_ns_(std::max(1.0, static_cast<double>(times_ns[2] - times_ns[1]))) {
  std::array<Eigen::Vector3d, 3> nodes;
  for (size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d normal = world_from_scanner[k].rotation.conjugate() * normal_world;
    nodes[k] << normal.head<2>(),
        distance - normal_world.dot(world_from_scanner[k].translation);
  }
  constant_ = nodes[1];
  linear_ = 0.5 * (nodes[2] - nodes[0]);
  quadratic_ = 0.5 * (nodes[0] + nodes[2]) - nodes[1];
}

Eigen::Vector3d PlaneTrace::At(int64_t time_ns) const {
  const double tau = static_cast<double>(time_ns - middle_ns_) / half_span_ns_;
  return constant_ + tau * (linear_ + tau * quadratic_);
}

ObservationPoses::ObservationPoses(const std::array<int64_t, 3>& node_times_ns,
                                   PoseSampler* poses)
    : times_ns(node_times_ns) {
  for (size_t k = 0; k < 3; ++k) world_from_body[k] = poses->WorldFromBody(times_ns[k]);
}

ObservationPoses::ObservationPoses(const Trajectory& trajectory,
                                   const Observation& observation)
    : times_ns(observation.measurement.node_times_ns) {
  PoseSampler poses(trajectory);
  for (size_t k = 0; k < 3; ++k) world_from_body[k] = poses.WorldFromBody(times_ns[k]);
}

Eigen::Vector3d ObservationPoses::ToWorld(const Rigid3d& body_from_scanner,
                                          const Eigen::Vector2d& p_scanner,
                                          int64_t time_ns) const {
  const Eigen::Vector3d p_body =
      body_from_scanner * Eigen::Vector3d(p_scanner.x(), p_scanner.y(), 0.0);
  const Eigen::Vector3d at_middle = world_from_body[1] * p_body;
  if (times_ns[2] == times_ns[1]) return at_middle;
  const double tau = static_cast<double>(time_ns - times_ns[1]) /
                     static_cast<double>(times_ns[2] - times_ns[1]);
  return 0.5 * tau * (tau - 1.0) * (world_from_body[0] * p_body) +
         (1.0 - tau * tau) * at_middle +
         0.5 * tau * (tau + 1.0) * (world_from_body[2] * p_body);
}

const ObservationPoses& SharedPoses::Of(const Observation& observation) {
  const std::array<int64_t, 3>& times_ns = observation.measurement.node_times_ns;
  for (const ObservationPoses& poses : kept_) {
    if (poses.times_ns == times_ns) return poses;
  }
  const ObservationPoses poses(times_ns, &sampler_);
  if (kept_.size() < kNumKept) {
    kept_.push_back(poses);
    return kept_.back();
  }
  next_ = (next_ + 1) % kNumKept;
  return kept_[next_] = poses;
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

LineDeviation DeviationFromPlane(const Observation& observation,
                                 const Rigid3d& body_from_scanner,
                                 const ObservationPoses& poses,
                                 const Landmark& landmark) {
  const Eigen::Vector3d normal = landmark.Normal();
  const double distance = landmark.Distance();
  const auto& root = observation.measurement.root;
  Eigen::Matrix<double, 9, 1> g;
  for (int k = 0; k < 3; ++k) {
    const Rigid3d world_from_scanner =
        poses.world_from_body[static_cast<size_t>(k)] * body_from_scanner;
    const Eigen::Vector3d normal_scanner = world_from_scanner.rotation.conjugate() * normal;
    g.segment<3>(3 * k) << normal_scanner.x(), normal_scanner.y(),
        normal.dot(world_from_scanner.translation) - distance;
  }
  // A line that deviates by offset + slope * (tangent . (s - centroid)) adds shift * (offset,
  // slope) to g, the same at every node.
  Eigen::Matrix<double, 9, 2> shift;
  for (int k = 0; k < 3; ++k) {
    shift.middleRows<3>(3 * k) << 0.0, observation.tangent.x(), 0.0,
        observation.tangent.y(),  //
        1.0, -observation.tangent.dot(observation.centroid);
  }
  const Rigid3d world_from_scanner = poses.middle() * body_from_scanner;
  const SegmentWeights weights = WeightsOn(observation, world_from_scanner.rotation, normal);
  const Eigen::VectorXd residuals =
      weights.scale * (root * g) + weights.offset * observation.measurement.offset;
  const Eigen::MatrixXd design = weights.scale * (root * shift);
  const Eigen::Matrix2d information = design.transpose() * design;

  LineDeviation deviation;
  deviation.covariance = information.inverse();
  deviation.value = deviation.covariance * (design.transpose() * residuals);
  deviation.chi2 = residuals.squaredNorm() +
                   weights.offset * weights.offset * observation.measurement.constant;
  deviation.remaining_chi2 =
      std::max(0.0, deviation.chi2 - deviation.value.dot(information * deviation.value));
  deviation.num_residuals = static_cast<int>(residuals.size());

  const Eigen::Vector3d centroid_world =
      world_from_scanner *
      Eigen::Vector3d(observation.centroid.x(), observation.centroid.y(), 0.0);
  const Eigen::Vector3d tangent_world =
      world_from_scanner.rotation *
      Eigen::Vector3d(observation.tangent.x(), observation.tangent.y(), 0.0);
  const Eigen::Vector3d arm = centroid_world - poses.middle().translation;
  deviation.by_pose.row(0) << arm.cross(normal).transpose(), normal.transpose();
  deviation.by_pose.row(1) << tangent_world.cross(normal).transpose(), 0.0, 0.0, 0.0;
  deviation.by_plane = landmark.DeviationJacobian(centroid_world, tangent_world);
  return deviation;
}

}  // namespace plumbline
