#include "factors/segment/segment_compression.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "factors/segment/segment_measurement.h"
#include "factors/segment/segment_moments.h"

namespace plumbline {
namespace {

// Limits of the motion and geometry that CompressSegment's accuracy holds for; see the header.
constexpr double kMaxPlaneDistance = 100.0;
constexpr double kMaxVelocity = 10.0;       // rad/s and m/s
constexpr double kMaxAcceleration = 100.0;  // rad/s^2 and m/s^2
constexpr double kMaxLoss = 1e-3;           // standard deviations of one range

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

// Sums of value(i) tau^j, j below num_powers; value(i) is that of four points, from i on.
template <int num_powers, typename Value>
Eigen::Array<double, num_powers, 1> SumByPower(const double* tau,
                                               size_t end,
                                               const Value& value) {
  std::array<Eigen::Array4d, num_powers> sums;
  sums.fill(Eigen::Array4d::Zero());
  for (size_t i = 0; i < end; i += 4) {
    const Eigen::Map<const Eigen::Array4d> tau_i(tau + i);
    Eigen::Array4d term = value(i);
    for (Eigen::Array4d& sum : sums) {
      sum += term;
      term *= tau_i;
    }
  }
  Eigen::Array<double, num_powers, 1> result;
  for (int j = 0; j < num_powers; ++j) result[j] = sums[static_cast<size_t>(j)].sum();
  return result;
}

// Cholesky's elimination, largest remaining pivot first: matrix = root^T root. Ends where the
// rows that are left can not matter: the entries of the vector that they multiply are at most
// one.
struct Root {
  // [ root | offset | bend | range ], root^T [ offset | bend | range ] = gradients
  Eigen::Matrix<double, 9, 12, Eigen::RowMajor> rows;
  int num_rows = 0;
};

// Columns: of the matrix with the three gradients' entries below.
using MatrixAndGradients = Eigen::Matrix<double, 12, 9>;

Root Eliminate(MatrixAndGradients matrix) {
  // A column of which less than this share is left is a combination of the others.
  constexpr double kTolerance = 1e-14;
  constexpr double kBound = 3.0;  // of the vector's norm
  Root root;
  const Vector9d full = matrix.diagonal();
  for (; root.num_rows < 9; ++root.num_rows) {
    int pivot = -1;
    double rest2 = 0.0;  // sum of squares of the rows that are left
    for (int k = 0; k < 9; ++k) {
      if (!(matrix(k, k) > kTolerance * full[k])) continue;
      rest2 += matrix(k, k);
      if (pivot < 0 || matrix(k, k) > matrix(pivot, pivot)) pivot = k;
    }
    if (pivot < 0 || (root.num_rows > 0 && kBound * std::sqrt(rest2) <= kMaxLoss)) break;
    const Eigen::Matrix<double, 12, 1> row =
        matrix.col(pivot) / std::sqrt(matrix(pivot, pivot));
    root.rows.row(root.num_rows) = row.transpose();
    for (int k = 0; k < 9; ++k) matrix.col(k) -= row[k] * row;
    matrix.row(pivot).setZero();
    matrix.col(pivot).setZero();
  }
  return root;
}

// With g(tau) = h_0 + tau h_1 + tau^2 h_2 about the segment's own middle and half span, in
// nanoseconds: h_j = sum_k at(j, k) g_k, g_k at the nodes; h_0 = g_0 where these coincide.
Eigen::Matrix3d PolynomialOf(const std::array<int64_t, 3>& nodes_ns,
                             int64_t middle_ns,
                             double half_span_ns) {
  if (nodes_ns[0] == nodes_ns[2]) return Eigen::Vector3d::UnitX().asDiagonal();
  Eigen::Matrix3d powers;
  for (int k = 0; k < 3; ++k) {
    const double tau =
        static_cast<double>(nodes_ns[static_cast<size_t>(k)] - middle_ns) / half_span_ns;
    powers.row(k) << 1.0, tau, tau * tau;
  }
  return powers.inverse();
}

}  // namespace

std::array<int64_t, 3> NodesOfSpan(int64_t first_ns, int64_t last_ns) {
  const int64_t half_span_ns = (last_ns - first_ns) / 2;
  return {first_ns, first_ns + half_span_ns, first_ns + 2 * half_span_ns};
}

SegmentMeasurement CompressSegment(const Eigen::Matrix2Xd& points_scanner,
                                   const std::vector<int64_t>& times_ns,
                                   const Eigen::VectorXd& whitening,
                                   const Eigen::VectorXd& offsets) {
  CHECK(!times_ns.empty());
  return CompressSegment(points_scanner,
                         times_ns,
                         whitening,
                         offsets,
                         NodesOfSpan(times_ns.front(), times_ns.back()));
}

SegmentMeasurement CompressSegment(const Eigen::Matrix2Xd& points_scanner,
                                   const std::vector<int64_t>& times_ns,
                                   const Eigen::VectorXd& whitening,
                                   const Eigen::VectorXd& offsets,
                                   const std::array<int64_t, 3>& nodes_ns) {
  const Eigen::Index num_points = points_scanner.cols();
  CHECK_GE(num_points, 1);
  CHECK_EQ(num_points, static_cast<Eigen::Index>(times_ns.size()));
  CHECK_EQ(num_points, whitening.size());
  CHECK(offsets.size() == 0 || offsets.size() == num_points) << offsets.size();

  SegmentMoments moments(points_scanner.col(0),
                         points_scanner.col(num_points - 1),
                         times_ns.front(),
                         times_ns.back());
  SegmentMoments::Points block;
  size_t size = 0;
  for (Eigen::Index i = 0; i < num_points; ++i) {
    block.x[size] = points_scanner(0, i);
    block.y[size] = points_scanner(1, i);
    block.since_start_ns[size] =
        static_cast<double>(times_ns[static_cast<size_t>(i)] - times_ns.front());
    block.weight[size] = whitening[i] * whitening[i];
    block.offset[size] = offsets.size() > 0 ? offsets[i] / whitening[i] : 0.0;
    block.by_range[size] = 0.0;
    if (++size < SegmentMoments::kBlock && i + 1 < num_points) continue;
    moments.Add(block, size);
    size = 0;
  }
  return moments.Compress(nodes_ns);
}

SegmentMoments::SegmentMoments(const Eigen::Vector2d& start,
                               const Eigen::Vector2d& end,
                               int64_t start_ns,
                               int64_t end_ns)
    : middle_(0.5 * (start + end)), start_ns_(start_ns), end_ns_(end_ns) {
  CHECK_LE(start_ns, end_ns);
  const Eigen::Vector2d along = end - start;
  const double length = along.norm();
  if (length > 0.0) along_ = along / length;
  const int64_t half_span_ns = NodesOfSpan(start_ns, end_ns)[1] - start_ns;
  half_span_ns_ = static_cast<double>(half_span_ns);
  inverse_half_span_ = half_span_ns > 0 ? 1.0 / half_span_ns_ : 0.0;
}

void SegmentMoments::Add(const Points& points, size_t num_points) {
  // Points across by less do not change a residual by a millionth of its standard deviation.
  constexpr double kNegligible = 1e-9;
  CHECK_LE(num_points, kBlock);
  num_points_ += static_cast<int>(num_points);
  Values along, across, tau, weight, offset, by_range;
  for (size_t i = 0; i < num_points; ++i) {
    const double from_x = points.x[i] - middle_.x();
    const double from_y = points.y[i] - middle_.y();
    along[i] = along_.x() * from_x + along_.y() * from_y;
    across[i] = along_.x() * from_y - along_.y() * from_x;
    tau[i] = (points.since_start_ns[i] - half_span_ns_) * inverse_half_span_;
    weight[i] = points.weight[i];
    offset[i] = points.offset[i];
    by_range[i] = points.by_range[i];
  }
  size_t end = num_points;
  for (; end % 4 != 0; ++end) {  // companions without weight
    along[end] = across[end] = tau[end] = weight[end] = offset[end] = by_range[end] = 0.0;
  }
  double most_across = 0.0;
  for (size_t i = 0; i < num_points; ++i) {
    most_across = std::max(most_across, std::abs(across[i]));
  }
  const auto add = [&](Product product, const auto& value) {
    const auto sums = SumByPower<5>(tau.data(), end, value);
    for (int j = 0; j < 5; ++j) products_[static_cast<size_t>(j)][product] += sums[j];
  };
  const auto add_with_offset = [&](int row, const auto& value) {
    const auto sums = SumByPower<3>(tau.data(), end, value);
    with_offset_.row(row) += sums.matrix().transpose();
  };
  const auto add_with_range = [&](int row, const auto& value) {
    const auto sums = SumByPower<3>(tau.data(), end, value);
    with_range_.row(row) += sums.matrix().transpose();
  };
  using Four = Eigen::Map<const Eigen::Array4d>;
  const auto a = [&](size_t i) { return Four(&along[i]); };
  const auto b = [&](size_t i) { return Four(&across[i]); };
  const auto w2 = [&](size_t i) { return Four(&weight[i]); };
  const auto o = [&](size_t i) { return Four(&offset[i]); };
  const auto r = [&](size_t i) { return Four(&by_range[i]); };
  // One group of sums after the other: the processor's registers hold a group, not all of the
  // forty.
  add(kOne, w2);
  add(kAlong, [&](size_t i) { return w2(i) * a(i); });
  add(kAlong2, [&](size_t i) { return w2(i) * a(i) * a(i); });
  const auto add_with_along2 = [&](int row, const auto& value) {
    const auto sums = SumByPower<3>(tau.data(), end, value);
    with_along2_.row(row) += sums.matrix().transpose();
  };
  const auto sum = [&](const auto& value) { return SumByPower<1>(tau.data(), end, value)[0]; };
  add_with_along2(0, [&](size_t i) { return w2(i) * a(i) * a(i) * a(i); });
  along4_ += sum([&](size_t i) { return w2(i) * a(i) * a(i) * a(i) * a(i); });
  offset_with_along2_ += sum([&](size_t i) { return w2(i) * o(i) * a(i) * a(i); });
  add_with_offset(0, [&](size_t i) { return w2(i) * o(i) * a(i); });
  add_with_offset(2, [&](size_t i) { return w2(i) * o(i); });
  offset2_ += sum([&](size_t i) { return w2(i) * o(i) * o(i); });
  add_with_range(0, [&](size_t i) { return w2(i) * r(i) * a(i); });
  add_with_range(2, [&](size_t i) { return w2(i) * r(i); });
  range2_ += sum([&](size_t i) { return w2(i) * r(i) * r(i); });
  offset_with_range_ += sum([&](size_t i) { return w2(i) * o(i) * r(i); });
  if (most_across < kNegligible) return;
  add(kAcross, [&](size_t i) { return w2(i) * b(i); });
  add(kAlongAcross, [&](size_t i) { return w2(i) * a(i) * b(i); });
  add(kAcross2, [&](size_t i) { return w2(i) * b(i) * b(i); });
  add_with_along2(1, [&](size_t i) { return w2(i) * a(i) * a(i) * b(i); });
  add_with_offset(1, [&](size_t i) { return w2(i) * o(i) * b(i); });
  add_with_range(1, [&](size_t i) { return w2(i) * r(i) * b(i); });
}

Eigen::Vector2d SegmentMoments::Centroid() const {
  const double a = products_[0][kAlong] / sum_weights();
  const double b = products_[0][kAcross] / sum_weights();
  return middle_ + a * along_ + b * Eigen::Vector2d(-along_.y(), along_.x());
}

Matrix9d SegmentMoments::Matrix() const {
  Matrix9d matrix;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const std::array<double, 6>& s = products_[static_cast<size_t>(i + j)];
      matrix.block<3, 3>(3 * i, 3 * j) << s[kAlong2], s[kAlongAcross], s[kAlong],
          s[kAlongAcross], s[kAcross2], s[kAcross], s[kAlong], s[kAcross], s[kOne];
    }
  }
  return matrix;
}

Eigen::Matrix3d SegmentMoments::WithBend() const {
  const double centre = CentreAlong();
  Eigen::Matrix3d with_bend;
  for (int j = 0; j < 3; ++j) {
    const std::array<double, 6>& s = products_[static_cast<size_t>(j)];
    const Eigen::Vector3d with_along2(with_along2_(0, j), with_along2_(1, j), s[kAlong2]);
    const Eigen::Vector3d with_along(s[kAlong2], s[kAlongAcross], s[kAlong]);
    const Eigen::Vector3d alone(s[kAlong], s[kAcross], s[kOne]);
    with_bend.col(j) =
        0.5 * (with_along2 - 2.0 * centre * with_along + centre * centre * alone);
  }
  return with_bend;
}

double SegmentMoments::Bend2() const {
  const double c = CentreAlong();
  const std::array<double, 6>& s = products_[0];
  const double sum = along4_ - 4.0 * c * with_along2_(0, 0) + 6.0 * c * c * s[kAlong2] -
                     4.0 * c * c * c * s[kAlong] + c * c * c * c * s[kOne];
  return 0.25 * sum;
}

double SegmentMoments::OffsetWithBend() const {
  const double c = CentreAlong();
  return 0.5 *
         (offset_with_along2_ - 2.0 * c * with_offset_(0, 0) + c * c * with_offset_(2, 0));
}

// (x, y, 1) . h = (a, b, 1) . (frame h)
Eigen::Matrix3d SegmentMoments::Frame() const {
  Eigen::Matrix3d frame;
  frame << along_.x(), along_.y(), 0.0,  //
      -along_.y(), along_.x(), 0.0,      //
      middle_.x(), middle_.y(), 1.0;
  return frame;
}

SegmentMeasurement SegmentMoments::Compress(const std::array<int64_t, 3>& nodes_ns) const {
  CHECK_GE(num_points_, 1);
  SegmentMeasurement measurement;
  measurement.node_times_ns = nodes_ns;
  const int64_t node_half_span_ns = nodes_ns[2] - nodes_ns[1];
  CHECK_EQ(node_half_span_ns, nodes_ns[1] - nodes_ns[0]);
  measurement.num_nodes = node_half_span_ns == 0 ? 1 : 3;

  // About the segment's own middle and half span. The columns are scaled by the largest
  // plausible h.
  const double own_half_span_ns = std::max(1.0, half_span_ns_);
  const double half_span_s = own_half_span_ns * 1e-9;
  const double way = kMaxVelocity * half_span_s;
  const double bend = 0.5 * kMaxAcceleration * half_span_s * half_span_s;
  Eigen::Matrix<double, 12, 1> scale;
  scale << 1.0, 1.0, kMaxPlaneDistance, way, way, way, bend, bend, bend, 1.0, 1.0, 1.0;
  const Eigen::Matrix3d with_bend = WithBend();
  MatrixAndGradients matrix;
  matrix << Matrix(), Eigen::Map<const Vector9d>(with_offset_.data()).transpose(),
      Eigen::Map<const Vector9d>(with_bend.data()).transpose(),
      Eigen::Map<const Vector9d>(with_range_.data()).transpose();
  const Root root = Eliminate(scale.asDiagonal() * matrix * scale.head<9>().asDiagonal());
  const int64_t own_middle_ns = NodesOfSpan(start_ns_, end_ns_)[1];
  const Eigen::Matrix3d to_nodes =
      PolynomialOf(nodes_ns, own_middle_ns, own_half_span_ns).transpose();
  const Eigen::Matrix3d frame = Frame();
  // In a row of nine: (a, b, 1) by power of tau, or (x, y, 1) by node.
  using Nine = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const Nine unscale = Eigen::Map<const Nine>(scale.data()).cwiseInverse();
  measurement.rows = root.rows.topLeftCorner(root.num_rows, SegmentMeasurement::kColumns);
  for (int i = 0; i < root.num_rows; ++i) {
    Eigen::Map<Nine> row(measurement.rows.row(i).data());
    row = to_nodes * row.cwiseProduct(unscale) * frame;
  }
  // Rounding leaves of the whole what is no rest.
  constexpr double kRounding = 1e-10;
  const double bend2 = Bend2();
  const double rest2 = bend2 - measurement.bend().squaredNorm();
  if (rest2 > kRounding * bend2) {
    measurement.bend_rest = std::sqrt(rest2);
    measurement.bend_offset =
        (OffsetWithBend() - measurement.bend().dot(measurement.offset())) /
        measurement.bend_rest;
  }
  const double range_rest2 = range2_ - measurement.range().squaredNorm();
  if (range_rest2 > kRounding * range2_) {
    measurement.range_rest = std::sqrt(range_rest2);
    measurement.range_offset =
        (offset_with_range_ - measurement.range().dot(measurement.offset())) /
        measurement.range_rest;
  }
  measurement.centroid = Centroid();
  measurement.tangent = along_;
  measurement.constant = std::max(0.0, offset2_ - measurement.offset().squaredNorm());
  return measurement;
}

}  // namespace plumbline
