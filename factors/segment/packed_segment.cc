#include "factors/segment/packed_segment.h"

#include <glog/logging.h>

#include <Eigen/LU>

#include "factors/segment/segment_measurement.h"

namespace plumbline {
namespace {

// Coefficients of a row for the three nodes.
using NodeRows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

}  // namespace

Eigen::Matrix3d SegmentFrame::Matrix() const {
  const Eigen::Vector2d t = tangent.cast<double>();
  const Eigen::Vector2d o = origin.cast<double>();
  Eigen::Matrix3d matrix;
  matrix << t.x(), -t.y(), o.x(),  //
      t.y(), t.x(), o.y(),         //
      0.0, 0.0, 1.0;
  return matrix;
}

PackedSegment::PackedSegment(const SegmentMeasurement& measurement, const SegmentFrame& frame)
    : frame_(frame),
      first_node_ns_(measurement.node_times_ns[0]),
      half_span_ns_(
          static_cast<int32_t>(measurement.node_times_ns[1] - measurement.node_times_ns[0])),
      constant_(static_cast<float>(measurement.constant)),
      bend_rest_(static_cast<float>(measurement.bend_rest)),
      bend_offset_(static_cast<float>(measurement.bend_offset)),
      range_rest_(static_cast<float>(measurement.range_rest)),
      range_offset_(static_cast<float>(measurement.range_offset)) {
  CHECK_EQ(measurement.node_times_ns[1] - measurement.node_times_ns[0], half_span_ns_);
  CHECK_EQ(measurement.node_times_ns[2] - measurement.node_times_ns[1], half_span_ns_);
  CHECK(measurement.rows.rows() == 0 || measurement.num_nodes == num_nodes());
  const Eigen::Matrix3d to_own = frame.Matrix().inverse().transpose();
  SegmentMeasurement::Rows rows = measurement.rows;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    Eigen::Map<NodeRows> of_nodes(rows.row(i).data());
    of_nodes = of_nodes * to_own;
  }
  const Eigen::Matrix<float, Eigen::Dynamic, kColumns, Eigen::RowMajor, 9, kColumns> rounded =
      rows.cast<float>();
  rows_ = CompactArray<float>(rounded.data(), static_cast<size_t>(rounded.size()));
}

SegmentMeasurement PackedSegment::Unpack() const {
  SegmentMeasurement measurement;
  measurement.node_times_ns = node_times_ns();
  measurement.num_nodes = num_nodes();
  measurement.constant = constant_;
  measurement.bend_rest = bend_rest_;
  measurement.bend_offset = bend_offset_;
  measurement.range_rest = range_rest_;
  measurement.range_offset = range_offset_;
  measurement.centroid = frame_.origin.cast<double>();
  measurement.tangent = frame_.tangent.cast<double>();
  const Eigen::Matrix3d to_scanner = frame_.Matrix().transpose();
  measurement.rows = rows().cast<double>();
  for (Eigen::Index i = 0; i < measurement.rows.rows(); ++i) {
    Eigen::Map<NodeRows> of_nodes(measurement.rows.row(i).data());
    of_nodes = of_nodes * to_scanner;
  }
  return measurement;
}

}  // namespace plumbline
