#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry/scan_plane_motion.h"
#include "core/segmentation/segmentation.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/surface/landmark.h"
#include "factors/segment/packed_segment.h"
#include "factors/segment/segment_measurement.h"
#include "factors/util/compact_array.h"

namespace plumbline {

// A single beam of a segment.
struct ObservedPoint {
  Eigen::Vector2d position;  // scanner frame, m
  int64_t time_ns;
  double whitening;  // 1/m
  double offset;     // whitened, see SegmentMeasurement
};

// One segment of one scan line as the map keeps it: its beams compressed to a matrix of at
// most nine rows (factors/cost/segment_factor.h), a line for association, and its landmark. A
// long recording has millions of observations: no more is kept than is needed.
struct Observation {
  PackedSegment measurement;
  Eigen::Vector2f first_point = Eigen::Vector2f::Zero();  // scanner frame, m
  Eigen::Vector2f last_point = Eigen::Vector2f::Zero();
  int32_t start_ns = 0;  // of the first and last beam, time offset included, after the
  int32_t end_ns = 0;    // measurement's first node
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

  // End points, centroid and direction of the line, scanner frame, m.
  Eigen::Vector2d start() const { return first_point.cast<double>(); }
  Eigen::Vector2d end() const { return last_point.cast<double>(); }
  Eigen::Vector2d centroid() const { return measurement.frame().origin.cast<double>(); }
  Eigen::Vector2d tangent() const { return measurement.frame().tangent.cast<double>(); }
  int64_t start_time_ns() const { return measurement.first_node_ns() + start_ns; }
  int64_t end_time_ns() const { return measurement.first_node_ns() + end_ns; }
  int64_t middle_time_ns() const {
    return start_time_ns() + (end_time_ns() - start_time_ns()) / 2;
  }
  double length_m() const { return (end() - start()).norm(); }
};

// Compresses a segment to an observation. keep_points also stores the single beams.
Observation MakeObservation(const ScanLine& scan_line,
                            const Scanner& scanner,
                            const Segment& segment,
                            bool keep_points);

// Compresses a segment with its beams taken to the trace of a plane that is known better than
// the segment's own line: lever arms and weights then carry none of the segment's noise, whose
// products with itself would turn the plane.
Observation MakeObservationOn(const PlaneTrace& trace,
                              const ScanLine& scan_line,
                              const Scanner& scanner,
                              const Segment& segment,
                              bool keep_points);

// Moves the end points of an observation inwards, where they lie beyond the feet of the first and
// last measured points on its line: a beam that grazes a plane meets it anywhere, the foot is as
// exact as the range. Elsewhere, the intersection of beam and line is the more exact end.
void EndAtPoints(const ScanLine& scan_line, Observation* observation);

// The range at which a beam along a unit vector of the scan plane meets a cylinder from the
// side that was seen; nothing where it does not.
std::optional<double> RangeOnCylinder(const Landmark& cylinder,
                                      const ScanPlacement& placement,
                                      const Eigen::Vector2d& direction);

// Makes an observation as MakeObservationOn does, with the beams taken to where they meet a
// cylinder. motion: the scan plane's, in the world.
Observation MakeObservationOnArc(const Landmark& cylinder,
                                 const ScanMotion& motion,
                                 const ScanLine& scan_line,
                                 const Scanner& scanner,
                                 const Segment& segment,
                                 bool keep_points);

// The weights that take the whitening in the scan plane to that of point-to-plane distances.
// With c the length of the plane normal's part in the scan plane, a distance's standard
// deviation is c times the one in the scan plane (the beam meets the plane obliquely), plus
// what the beams' angular noise across the scan plane adds.
SegmentWeights WeightsOn(const Observation& observation,
                         const Eigen::Quaterniond& world_from_scanner,
                         const Eigen::Vector3d& normal_world);

}  // namespace plumbline
