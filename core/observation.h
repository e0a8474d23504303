#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/landmark.h"
#include "core/rig.h"
#include "core/scan_line.h"
#include "core/scan_motion.h"
#include "core/segmentation.h"
#include "core/trajectory.h"
#include "factors/compact_array.h"
#include "factors/stored_measurement.h"

namespace plumbline {

// A single beam of a segment.
struct ObservedPoint {
  Eigen::Vector2d position;  // scanner frame, m
  int64_t time_ns;
  double whitening;  // 1/m
  double offset;     // whitened, see SegmentMeasurement
};

// What is kept of one segment of one scan line: its beams compressed to a matrix of at most
// nine rows (factors/segment_factor.h), a line for association, and its landmark. A long
// recording has millions of them: no more is kept than is needed.
struct Observation {
  StoredMeasurement measurement;
  Eigen::Vector2f first_point = Eigen::Vector2f::Zero();  // scanner frame, m
  Eigen::Vector2f last_point = Eigen::Vector2f::Zero();
  int64_t start_time_ns = 0;  // of the first and last beam, time offset included
  int64_t end_time_ns = 0;
  int scan_index = 0;
  int scan_line_index = 0;  // position in the recording's sequence of scan lines
  int scanner_index = 0;
  int first_beam = 0;
  int last_beam = 0;  // inclusive
  int num_points = 0;
  int landmark_id = -1;
  int revision = 0;             // counts changes of its beams
  int taken_to = -1;            // landmark on whose trace the beams are; -1: on its own line
  float sigma_offset_m = 0.0F;  // of the line, along its normal at the centroid
  float sigma_direction_rad = 0.0F;
  float out_of_plane_ratio = 0.0F;  // see WeightsOn
  CompactArray<int> excluded_beams;
  CompactArray<ObservedPoint> points;  // kept only for the per-point factor

  // Of its line, scanner frame, m.
  Eigen::Vector2d start() const { return first_point.cast<double>(); }
  Eigen::Vector2d end() const { return last_point.cast<double>(); }
  Eigen::Vector2d centroid() const { return measurement.frame().origin.cast<double>(); }
  Eigen::Vector2d tangent() const { return measurement.frame().tangent.cast<double>(); }
  int64_t middle_time_ns() const { return start_time_ns + (end_time_ns - start_time_ns) / 2; }
  double length_m() const { return (end() - start()).norm(); }
};

// Compresses a segment. keep_points also stores the single beams.
Observation MakeObservation(const ScanLine& scan_line,
                            const Scanner& scanner,
                            const Segment& segment,
                            bool keep_points);

// Trace of a plane in the moving scan plane, normal(t) . p = distance(t), by the quadratic
// through three instants. Scanner frame; the normal's length is the sine of the angle between
// plane and scan plane.
class PlaneTrace {
 public:
  PlaneTrace(const std::array<int64_t, 3>& times_ns,
             const std::array<Rigid3d, 3>& world_from_scanner,
             const Eigen::Vector3d& normal_world,
             double distance);

  // ( normal, distance )
  Eigen::Vector3d At(int64_t time_ns) const {
    return AtShare(static_cast<double>(time_ns - middle_ns_) / half_span_ns_);
  }
  // In half spans from the middle instant: -1 at the first, 1 at the last.
  Eigen::Vector3d AtShare(double tau) const {
    return constant_ + tau * (linear_ + tau * quadratic_);
  }
  // Of one component, by rising powers of the share.
  std::array<double, 3> Polynomial(int row) const {
    return {constant_[row], linear_[row], quadratic_[row]};
  }
  int64_t middle_ns() const { return middle_ns_; }
  double half_span_ns() const { return half_span_ns_; }
  // The same lines with normals of unit length at the three instants; between them it differs
  // from one by less than the motion's third derivative makes.
  PlaneTrace WithUnitNormal() const;

 private:
  void Interpolate(const std::array<Eigen::Vector3d, 3>& nodes);

  int64_t middle_ns_;
  double half_span_ns_;
  Eigen::Vector3d constant_;
  Eigen::Vector3d linear_;
  Eigen::Vector3d quadratic_;
};

// The same, with the beams taken to the trace of a plane that is known better than the line of
// the segment: lever arms and weights then carry none of the segment's own noise, whose
// products with itself would turn the plane.
Observation MakeObservationOn(const PlaneTrace& trace,
                              const ScanLine& scan_line,
                              const Scanner& scanner,
                              const Segment& segment,
                              bool keep_points);

// The rig's poses at the three interpolation nodes of an observation.
struct ObservationPoses {
  std::array<int64_t, 3> times_ns;
  std::array<Rigid3d, 3> world_from_body;

  ObservationPoses(const Trajectory& trajectory, const Observation& observation);
  ObservationPoses(const std::array<int64_t, 3>& times_ns, PoseSampler* poses);
  const Rigid3d& middle() const { return world_from_body[1]; }
  std::array<Rigid3d, 3> WorldFromScanner(const Rigid3d& body_from_scanner) const {
    return {world_from_body[0] * body_from_scanner,
            world_from_body[1] * body_from_scanner,
            world_from_body[2] * body_from_scanner};
  }
  ScanMotion MotionOf(const Rigid3d& body_from_scanner) const {
    return {times_ns, WorldFromScanner(body_from_scanner)};
  }
};

// ObservationPoses of observations of the same few scan lines, each computed once. The
// trajectory stays as it is meanwhile.
class SharedPoses {
 public:
  explicit SharedPoses(const Trajectory& trajectory) : sampler_(trajectory) {}

  // Valid until the next call.
  const ObservationPoses& Of(const Observation& observation);

 private:
  static constexpr size_t kNumKept = 4;  // scan lines; a scan's are asked for in any order

  PoseSampler sampler_;
  std::vector<ObservationPoses> kept_;
  size_t next_ = 0;
};

// Factors from the whitening in the scan plane to that of point-to-plane distances. With c the
// length of the plane normal's part in the scan plane, a distance's standard deviation is c
// times the one in the scan plane (the beam meets the plane at a slant), plus what the beams'
// angular noise across the scan plane adds.
SegmentWeights WeightsOn(const Observation& observation,
                         const Eigen::Quaterniond& world_from_scanner,
                         const Eigen::Vector3d& normal_world);

// How far an observed line deviates from a plane: signed distance at the centroid (m) and its
// change along the tangent (rad), estimated from the compressed beams, with their covariance.
struct LineDeviation {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  Eigen::Matrix<double, 2, 6> by_pose;  // world-frame rotation, position at the middle node
  Eigen::Matrix2d by_plane;             // landmark parameters
  double chi2 = 0.0;                    // of all the whitened residuals, deviation included
  double remaining_chi2 = 0.0;          // without the deviation
  int num_residuals = 0;
};

LineDeviation DeviationFromPlane(const Observation& observation,
                                 const Rigid3d& body_from_scanner,
                                 const ObservationPoses& poses,
                                 const Landmark& landmark);

}  // namespace plumbline
