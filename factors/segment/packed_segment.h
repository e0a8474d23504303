#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "factors/segment/segment_measurement.h"
#include "factors/util/compact_array.h"

namespace plumbline {

// The approximate place of a segment in the scan plane: coordinates in it are exact, rounded
// as it is. On a surface that bends its origin has to be the segment's centroid.
struct SegmentFrame {
  Eigen::Vector2f origin = Eigen::Vector2f::Zero();  // scanner frame, m
  Eigen::Vector2f tangent = Eigen::Vector2f::UnitX();

  // (x, y, 1) = matrix (along, across, 1), from the origin.
  Eigen::Matrix3d Matrix() const;
};

// A measurement as it is kept while a map is made, in single precision and little memory.
//
// Its rows are those of the segment's own frame: with (x, y, 1) = F (along, across, 1) in the
// scan plane,
//   U g_k = (U F^-T) (F^T g_k)
// where F^T g_k is ( slope of the plane against the segment, the cosine that belongs to it,
// signed distance of the origin from the plane ). There nothing cancels: what is rounded is
// multiplied by the small slope and distance, or is small itself, as the points hardly lie off
// their line. Rounded in x and y, residuals would be wrong by 3e-8 of the range.
class PackedSegment {
 public:
  static constexpr int kColumns = SegmentMeasurement::kColumns;
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, kColumns, Eigen::RowMajor>;

  PackedSegment() = default;
  PackedSegment(const SegmentMeasurement& measurement, const SegmentFrame& frame);

  const SegmentFrame& frame() const { return frame_; }
  // [ U F^-T | b | c | r ].
  Eigen::Map<const Rows> rows() const {
    return {rows_.begin(), static_cast<Eigen::Index>(rows_.size()) / kColumns, kColumns};
  }
  int64_t first_node_ns() const { return first_node_ns_; }
  std::array<int64_t, 3> node_times_ns() const {
    const int64_t half_span_ns = half_span_ns_;
    return {first_node_ns_, first_node_ns_ + half_span_ns, first_node_ns_ + 2 * half_span_ns};
  }
  int num_nodes() const { return half_span_ns_ == 0 ? 1 : 3; }
  double constant() const { return constant_; }
  double bend_rest() const { return bend_rest_; }
  double bend_offset() const { return bend_offset_; }
  double range_rest() const { return range_rest_; }
  double range_offset() const { return range_offset_; }
  // Returns the measurement in the scanner's frame.
  SegmentMeasurement Unpack() const;

  // Calls visit(member) for each: to keep them in a file and take them back.
  template <typename Visit>
  void VisitMembers(Visit& visit) {
    visit(frame_.origin);
    visit(frame_.tangent);
    visit(rows_);
    visit(first_node_ns_);
    visit(half_span_ns_);
    visit(constant_);
    visit(bend_rest_);
    visit(bend_offset_);
    visit(range_rest_);
    visit(range_offset_);
  }

 private:
  SegmentFrame frame_;
  CompactArray<float> rows_;
  int64_t first_node_ns_ = 0;
  int32_t half_span_ns_ = 0;  // up to 2 s
  float constant_ = 0.0F;
  float bend_rest_ = 0.0F;
  float bend_offset_ = 0.0F;
  float range_rest_ = 0.0F;
  float range_offset_ = 0.0F;
};

}  // namespace plumbline
