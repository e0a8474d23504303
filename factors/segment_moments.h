#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "factors/segment_factor.h"

namespace plumbline {

// Sums over a segment's points of m m^T, m o and o^2, from which its measurement follows; o is
// a point's offset, whitened with w, and
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

  // A point (x, y), taken so long after the first; w^2 in 1/m^2; the offset in m, without w.
  void Add(double x, double y, double since_start_ns, double weight, double offset) {
    if (num_waiting_ == kBlock) TakeUpWaiting();
    const auto i = static_cast<size_t>(num_waiting_++);
    const double from_x = x - middle_.x();
    const double from_y = y - middle_.y();
    waiting_.along[i] = along_.x() * from_x + along_.y() * from_y;
    waiting_.across[i] = along_.x() * from_y - along_.y() * from_x;
    waiting_.tau[i] = (since_start_ns - half_span_ns_) * inverse_half_span_;
    waiting_.weight[i] = weight;
    waiting_.offset[i] = offset;
    ++num_points_;
  }

  // Takes up the last points. To be called once, before what follows.
  void Finish() { TakeUpWaiting(); }

  int num_points() const { return num_points_; }
  double sum_weights() const { return products_[0][kOne]; }
  // Mean of the points by weight.
  Eigen::Vector2d Centroid() const;

  // See CompressSegment.
  SegmentMeasurement Compress(const std::array<int64_t, 3>& nodes_ns) const;

 private:
  // Points are taken up in blocks, one group of sums after the other: the processor's
  // registers hold a group, not all of the forty.
  static constexpr int kBlock = 32;
  struct Block {
    std::array<double, kBlock> along, across, tau, weight, offset;
  };
  enum Product { kAlong2, kAlongAcross, kAcross2, kAlong, kAcross, kOne };

  void TakeUpWaiting();
  Eigen::Matrix<double, 9, 9> Matrix() const;
  Eigen::Matrix3d Frame() const;

  Eigen::Vector2d middle_;
  Eigen::Vector2d along_ = Eigen::Vector2d::UnitX();
  int64_t start_ns_;
  int64_t end_ns_;
  double half_span_ns_;
  double inverse_half_span_;  // 0 if all points are of one instant
  int num_points_ = 0;
  int num_waiting_ = 0;
  Block waiting_;
  std::array<std::array<double, 6>, 5> products_{};        // by the power of tau
  Eigen::Matrix3d with_offset_ = Eigen::Matrix3d::Zero();  // columns: likewise; a, b, 1
  double offset2_ = 0.0;
};

}  // namespace plumbline
