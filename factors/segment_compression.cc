#include <glog/logging.h>

#include <Eigen/QR>
#include <algorithm>
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

// Number of leading rows of the triangular matrix that may matter: the entries of the vector
// that it multiplies are at most one.
Eigen::Index NumSignificantRows(const Eigen::MatrixXd& triangular) {
  const double bound = std::sqrt(static_cast<double>(triangular.cols()));
  Eigen::Index rows = triangular.rows();
  double rest2 = 0.0;
  while (rows > 1) {
    rest2 += triangular.row(rows - 1).squaredNorm();
    if (bound * std::sqrt(rest2) > kMaxLoss) break;
    --rows;
  }
  return rows;
}

}  // namespace

SegmentMeasurement CompressSegment(const Eigen::Matrix2Xd& points_scanner,
                                   const std::vector<int64_t>& times_ns,
                                   const Eigen::VectorXd& whitening,
                                   const Eigen::VectorXd& offsets) {
  const Eigen::Index num_points = points_scanner.cols();
  CHECK_GE(num_points, 1);
  CHECK_EQ(num_points, static_cast<Eigen::Index>(times_ns.size()));
  CHECK_EQ(num_points, whitening.size());
  CHECK(offsets.size() == 0 || offsets.size() == num_points) << offsets.size();
  CHECK_LE(times_ns.front(), times_ns.back());

  SegmentMeasurement measurement;
  measurement.num_points = static_cast<int>(num_points);
  const int64_t half_span_ns = (times_ns.back() - times_ns.front()) / 2;
  const int64_t middle_ns = times_ns.front() + half_span_ns;
  measurement.node_times_ns = {times_ns.front(), middle_ns, middle_ns + half_span_ns};
  measurement.num_nodes = half_span_ns == 0 ? 1 : 3;

  // With g(tau) = h_0 + tau h_1 + tau^2 h_2, tau = -1, 0, 1 at the nodes, the matrix of h is
  // [ m, tau m, tau^2 m ], m = w (x, y, 1). Its columns are scaled by the largest plausible h.
  const double half_span_s = static_cast<double>(half_span_ns) * 1e-9;
  const double rate = kMaxRotationRate * half_span_s;
  const double speed = kMaxSpeed * half_span_s;
  const double bend = 0.5 * kMaxAcceleration * half_span_s * half_span_s;
  Eigen::VectorXd scale(9);
  scale << 1.0, 1.0, kMaxPlaneDistance, rate, rate, speed, bend, bend, bend;
  const Eigen::Index num_columns = 3 * measurement.num_nodes;
  Eigen::MatrixXd matrix(num_points, num_columns);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const Eigen::RowVector3d row =
        whitening[i] * Eigen::RowVector3d(points_scanner(0, i), points_scanner(1, i), 1.0);
    matrix.block<1, 3>(i, 0) = row;
    if (measurement.num_nodes == 1) continue;
    const double tau = static_cast<double>(times_ns[static_cast<size_t>(i)] - middle_ns) /
                       static_cast<double>(half_span_ns);
    matrix.block<1, 3>(i, 3) = tau * row;
    matrix.block<1, 3>(i, 6) = tau * tau * row;
  }
  matrix *= scale.head(num_columns).asDiagonal();

  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
  const Eigen::Index size = std::min(num_points, num_columns);
  const Eigen::MatrixXd triangular =
      qr.matrixQR().topRows(size).triangularView<Eigen::Upper>();
  const Eigen::Index num_rows = NumSignificantRows(triangular);
  const Eigen::MatrixXd rows = triangular.topRows(num_rows) *
                               qr.colsPermutation().transpose() *
                               scale.head(num_columns).cwiseInverse().asDiagonal();
  measurement.offset.setZero(num_rows);
  if (offsets.size() > 0) {
    const Eigen::VectorXd rotated = qr.householderQ().transpose() * offsets;
    measurement.offset = rotated.head(num_rows);
    measurement.constant = rotated.tail(num_points - num_rows).squaredNorm();
  }
  measurement.root.setZero(num_rows, 9);
  if (measurement.num_nodes == 1) {
    measurement.root.leftCols<3>() = rows;
  } else {
    // h_0 = g_1,  h_1 = (g_2 - g_0) / 2,  h_2 = (g_0 - 2 g_1 + g_2) / 2.
    measurement.root.leftCols<3>() = 0.5 * (rows.rightCols<3>() - rows.middleCols<3>(3));
    measurement.root.middleCols<3>(3) = rows.leftCols<3>() - rows.rightCols<3>();
    measurement.root.rightCols<3>() = 0.5 * (rows.rightCols<3>() + rows.middleCols<3>(3));
  }
  return measurement;
}

}  // namespace plumbline
