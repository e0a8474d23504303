#include <glog/logging.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "factors/segment_factor.h"

namespace plumbline {
namespace {

// Limits of the motion and geometry that CompressSegment's accuracy holds for; see the header.
constexpr double kMaxPlaneDistance = 100.0;
constexpr double kMaxRotationRate = 10.0;
constexpr double kMaxSpeed = 10.0;
constexpr double kMaxAcceleration = 100.0;  // rad/s^2 and m/s^2
constexpr double kMaxLoss = 1e-3;           // standard deviations of one range

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

// Sums over a segment's points of m m^T, m o and o^2, where o is a point's offset and
//   m = w (a, b, 1, tau a, tau b, tau, tau^2 a, tau^2 b, tau^2)
// with a and b along and across the segment, from its middle. In these coordinates the columns
// are as independent of each other as they can be: b is next to nothing.
class Moments {
 public:
  Moments(const Eigen::Matrix2Xd& points, const Eigen::VectorXd& whitening)
      : middle_(0.5 * (points.col(0) + points.col(points.cols() - 1))) {
    const Eigen::Vector2d along = points.col(points.cols() - 1) - points.col(0);
    const double length = along.norm();
    if (length > 0.0) along_ = along / length;
    points_ = &points;
    whitening_ = &whitening;
  }

  void Add(Eigen::Index i, double tau, double offset) {
    const double weight = (*whitening_)[i];
    const Eigen::Vector2d from_middle = points_->col(i) - middle_;
    const double a = weight * along_.dot(from_middle);
    const double b = weight * (along_.x() * from_middle.y() - along_.y() * from_middle.x());
    const std::array<double, 6> products = {
        a * a, a * b, b * b, a * weight, b * weight, weight * weight};
    double power = 1.0;
    for (auto& sums : products_) {
      for (size_t k = 0; k < 6; ++k) sums[k] += power * products[k];
      power *= tau;
    }
    power = offset;
    for (int j = 0; j < 3; ++j) {
      with_offset_.segment<3>(3 * j) += power * Eigen::Vector3d(a, b, weight);
      power *= tau;
    }
    offset2_ += offset * offset;
  }

  Matrix9d Matrix() const {
    Matrix9d matrix;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const std::array<double, 6>& s = products_[static_cast<size_t>(i + j)];
        matrix.block<3, 3>(3 * i, 3 * j) << s[0], s[1], s[3], s[1], s[2], s[4], s[3], s[4],
            s[5];
      }
    }
    return matrix;
  }
  const Vector9d& with_offset() const { return with_offset_; }
  double offset2() const { return offset2_; }
  // (x, y, 1) . h = (a, b, 1) . (frame h)
  Eigen::Matrix3d frame() const {
    Eigen::Matrix3d frame;
    frame << along_.x(), along_.y(), 0.0,  //
        -along_.y(), along_.x(), 0.0,      //
        middle_.x(), middle_.y(), 1.0;
    return frame;
  }

 private:
  const Eigen::Matrix2Xd* points_;
  const Eigen::VectorXd* whitening_;
  Eigen::Vector2d middle_;
  Eigen::Vector2d along_ = Eigen::Vector2d::UnitX();
  std::array<std::array<double, 6>, 5> products_{};  // by the power of tau
  Vector9d with_offset_ = Vector9d::Zero();
  double offset2_ = 0.0;
};

// Cholesky's elimination, largest remaining pivot first: matrix = root^T root.
struct Root {
  Matrix9d rows = Matrix9d::Zero();
  Vector9d offset = Vector9d::Zero();  // root^T offset = gradient
  int rank = 0;
};

Root Eliminate(Matrix9d matrix, Vector9d gradient, int size) {
  // Of a column less than this share is left: it is a combination of the others.
  constexpr double kTolerance = 1e-14;
  Root root;
  const Vector9d full = matrix.diagonal();
  std::array<bool, 9> done{};
  for (; root.rank < size; ++root.rank) {
    int pivot = -1;
    for (int k = 0; k < size; ++k) {
      if (done[static_cast<size_t>(k)] || !(matrix(k, k) > kTolerance * full[k])) continue;
      if (pivot < 0 || matrix(k, k) > matrix(pivot, pivot)) pivot = k;
    }
    if (pivot < 0) break;
    done[static_cast<size_t>(pivot)] = true;
    const double scale = 1.0 / std::sqrt(matrix(pivot, pivot));
    Vector9d row = scale * matrix.col(pivot);
    for (int k = 0; k < 9; ++k) {
      if (k != pivot && done[static_cast<size_t>(k)]) row[k] = 0.0;
    }
    const double offset = scale * gradient[pivot];
    matrix.noalias() -= row * row.transpose();
    gradient -= offset * row;
    root.rows.row(root.rank) = row.transpose();
    root.offset[root.rank] = offset;
  }
  return root;
}

// Number of leading rows that may matter: the entries of the vector that they multiply are at
// most one.
int NumSignificantRows(const Root& root) {
  constexpr double kBound = 3.0;  // of the vector's norm
  int rows = root.rank;
  double rest2 = 0.0;
  while (rows > 1) {
    rest2 += root.rows.row(rows - 1).squaredNorm();
    if (kBound * std::sqrt(rest2) > kMaxLoss) break;
    --rows;
  }
  return rows;
}

// With g(tau) = h_0 + tau h_1 + tau^2 h_2 about the segment's own middle and half span, in
// nanoseconds: h_j = sum_k at(j, k) g_k, g_k at the nodes.
Eigen::Matrix3d PolynomialOf(const std::array<int64_t, 3>& nodes_ns,
                             int64_t middle_ns,
                             double half_span_ns) {
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
  CHECK_LE(times_ns.front(), times_ns.back());

  SegmentMeasurement measurement;
  measurement.num_points = static_cast<int>(num_points);
  measurement.node_times_ns = nodes_ns;
  const int64_t middle_ns = nodes_ns[1];
  const int64_t half_span_ns = nodes_ns[2] - middle_ns;
  CHECK_EQ(half_span_ns, middle_ns - nodes_ns[0]);
  measurement.num_nodes = half_span_ns == 0 ? 1 : 3;

  // About the segment's own middle and half span. The columns are scaled by the largest
  // plausible h.
  const auto own = NodesOfSpan(times_ns.front(), times_ns.back());
  const auto own_half_span_ns = static_cast<double>(std::max<int64_t>(1, own[2] - own[1]));
  const double half_span_s = own_half_span_ns * 1e-9;
  const double rate = kMaxRotationRate * half_span_s;
  const double speed = kMaxSpeed * half_span_s;
  const double bend = 0.5 * kMaxAcceleration * half_span_s * half_span_s;
  Vector9d scale;
  scale << 1.0, 1.0, kMaxPlaneDistance, rate, rate, speed, bend, bend, bend;
  Moments moments(points_scanner, whitening);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const double tau = measurement.num_nodes == 1
                           ? 0.0
                           : static_cast<double>(times_ns[static_cast<size_t>(i)] - own[1]) /
                                 own_half_span_ns;
    moments.Add(i, tau, offsets.size() > 0 ? offsets[i] : 0.0);
  }
  const Root root = Eliminate(scale.asDiagonal() * moments.Matrix() * scale.asDiagonal(),
                              scale.cwiseProduct(moments.with_offset()),
                              3 * measurement.num_nodes);
  const int num_rows = NumSignificantRows(root);
  const Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor, 9, 9> rows =
      root.rows.topRows(num_rows) * scale.cwiseInverse().asDiagonal();
  measurement.offset = root.offset.head(num_rows);
  measurement.constant = std::max(0.0, moments.offset2() - measurement.offset.squaredNorm());

  const Eigen::Matrix3d frame = moments.frame();
  measurement.root.setZero(num_rows, 9);
  if (measurement.num_nodes == 1) {
    measurement.root.leftCols<3>() = rows.leftCols<3>() * frame;
    return measurement;
  }
  const Eigen::Matrix3d polynomial = PolynomialOf(nodes_ns, own[1], own_half_span_ns);
  for (int j = 0; j < 3; ++j) {
    const Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 9, 3> by_power =
        rows.middleCols<3>(3 * j) * frame;
    for (int k = 0; k < 3; ++k) {
      measurement.root.middleCols<3>(3 * k) += polynomial(j, k) * by_power;
    }
  }
  return measurement;
}

}  // namespace plumbline
