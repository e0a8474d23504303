#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "factors/segment/segment_measurement.h"

namespace plumbline {

// Sums over a segment's points of m m^T, m o, o^2, w m a^2 and the like of r, from which its
// measurement follows; o is a point's offset and r its derivative by the range, whitened with
// w, and
//   m = w (a, b, 1, tau a, tau b, tau, tau^2 a, tau^2 b, tau^2)
// with a and b along and across the segment, from its middle, and tau from -1 to 1. In these
// coordinates the columns are as independent of each other as they can be: b is next to
// nothing.
class SegmentMoments {
 public:
  // First and last point (scanner frame, m) and their instants.
  SegmentMoments(const Eigen::Vector2d& start,
                 const Eigen::Vector2d& end,
                 int64_t start_ns,
                 int64_t end_ns);

  // Points side by side, so that loops over them become vector instructions.
  static constexpr size_t kBlock = 32;
  using Values = std::array<double, kBlock>;
  struct Points {
    Values x, y;            // m
    Values since_start_ns;  // after the segment's first point
    Values weight;          // w^2 in 1/m^2
    Values offset;          // m, without w
    Values by_range;        // derivative of the offset
  };

  // The first num_points of these.
  void Add(const Points& points, size_t num_points);

  int num_points() const { return num_points_; }
  double sum_weights() const { return products_[0][kOne]; }
  // Mean of the points by weight.
  Eigen::Vector2d Centroid() const;

  // See CompressSegment.
  SegmentMeasurement Compress(const std::array<int64_t, 3>& nodes_ns) const;

 private:
  enum Product { kAlong2, kAlongAcross, kAcross2, kAlong, kAcross, kOne };

  Eigen::Matrix<double, 9, 9> Matrix() const;
  Eigen::Matrix3d Frame() const;
  // a at the centroid.
  double CentreAlong() const { return products_[0][kAlong] / products_[0][kOne]; }
  // Sums of w m c with c = a^2 / 2, a from the centroid; rows: a, b, 1.
  Eigen::Matrix3d WithBend() const;
  // The sums of w c^2 and w o c.
  double Bend2() const;
  double OffsetWithBend() const;

  Eigen::Vector2d middle_;
  Eigen::Vector2d along_ = Eigen::Vector2d::UnitX();
  int64_t start_ns_;
  int64_t end_ns_;
  double half_span_ns_;
  double inverse_half_span_;  // 0 if all points are of one instant
  int num_points_ = 0;
  std::array<std::array<double, 6>, 5> products_{};  // by the power of tau
  Eigen::Matrix3d with_offset_ =
      Eigen::Matrix3d::Zero();  // columns: by the power of tau; rows: a, b, 1
  // Sums of w a^2, laid out as with_offset_; the sum for 1 is in products_.
  Eigen::Matrix<double, 2, 3> with_along2_ = Eigen::Matrix<double, 2, 3>::Zero();
  double along4_ = 0.0;              // sum of w a^4
  double offset_with_along2_ = 0.0;  // sum of w o a^2
  double offset2_ = 0.0;
  // Sums of the derivative by the range, laid out as with_offset_.
  Eigen::Matrix3d with_range_ = Eigen::Matrix3d::Zero();
  double range2_ = 0.0;
  double offset_with_range_ = 0.0;
};

}  // namespace plumbline
