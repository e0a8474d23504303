#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace plumbline {

// All points of one segment of a scan line, compressed to at most nine rows.
//
// The whitened signed distance of point i, measured at t_i in the scan plane, is
//   e_i = w_i sum_k L_k(t_i) (x_i, y_i, 1) . g_k
//   g_k = ( (R_bs^T R(tau_k)^T n)_x, (R_bs^T R(tau_k)^T n)_y, n.(R(tau_k) t_bs + p(tau_k)) - d
//   )
// where g is interpolated in time by the quadratic through the nodes tau_0, tau_1, tau_2, L_k
// being its Lagrange weights. The N x 9 matrix of this linear form depends on the measurements
// only; an orthogonal transformation of its rows leaves U with
//   sum_i e_i^2 = |U g + b|^2 + constant,   g = (g_0, g_1, g_2).
//
// b and the constant come from the points' offsets: what a point lies off its place on the
// segment's line, along its beam. Left within (x_i, y_i), this noise of the range would stand
// in the residual and in its lever arm both; their product does not average out and turns the
// plane (errors in variables), by more than the bound allows for after a dozen walls.
//
// Where the surface bends, with the curvature k along the segment, a point that lies a from
// the segment's centroid is off the plane through the centroid by k a^2 / 2 as well: e_i gains
// w_i k a_i^2 / 2, and the rows k c. What of it no g can imitate is a row of its own, without
// U: k bend_rest + bend_offset.
//
// Ranges that are too long by b leave the offsets b times larger than they should be by the
// cosine between beam and normal, whitened: the rows lose b r. What of that no g can imitate,
// where the surface does not bend, is a row of its own as well: range_offset - b range_rest.
struct SegmentMeasurement {
  // Three instants, equally far from each other. A segment whose points were all taken within
  // 1 ns has num_nodes = 1: its nodes coincide and only g_0 counts.
  std::array<int64_t, 3> node_times_ns{};
  int num_nodes = 3;
  static constexpr int kColumns = 12;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, kColumns, Eigen::RowMajor, 9, kColumns>;
  Rows rows;              // [ U | b | c | r ]
  double constant = 0.0;  // sum of squares that no g changes, where the surface does not bend
  double bend_rest = 0.0;
  double bend_offset = 0.0;  // its square is part of constant
  double range_rest = 0.0;
  double range_offset = 0.0;                           // its square is part of constant
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();  // scanner frame, m
  Eigen::Vector2d tangent = Eigen::Vector2d::UnitX();  // of the segment, scanner frame

  auto root() const { return rows.leftCols<9>(); }
  auto offset() const { return rows.col(9); }
  auto bend() const { return rows.col(10); }
  auto range() const { return rows.col(11); }
};

// Effect of the plane on a measurement's whitening:
//   |scale U g + offset b|^2 + offset^2 constant
struct SegmentWeights {
  double scale = 1.0;
  double offset = 1.0;
};

// First, middle and last instant of a span, equally far from each other (to 1 ns).
std::array<int64_t, 3> NodesOfSpan(int64_t first_ns, int64_t last_ns);

}  // namespace plumbline
