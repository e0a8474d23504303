#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "factors/plane_model.h"
#include "factors/spline.h"

namespace ceres {
class CostFunction;
}

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
struct SegmentMeasurement {
  // Three instants, equally far from each other. A segment whose points were all taken within
  // 1 ns has num_nodes = 1: its nodes coincide and only g_0 counts.
  std::array<int64_t, 3> node_times_ns{};
  int num_nodes = 3;
  Eigen::Matrix<double, Eigen::Dynamic, 10, Eigen::RowMajor, 9, 10> rows;  // [ U | b ]
  double constant = 0.0;  // sum of squares that no g changes

  auto root() const { return rows.leftCols<9>(); }
  auto offset() const { return rows.col(9); }
};

// What the plane in question makes of a measurement's whitening:
//   |scale U g + offset b|^2 + offset^2 constant
struct SegmentWeights {
  double scale = 1.0;
  double offset = 1.0;
};

// Compresses the points (scanner frame, m; measured positions, motion not removed) with their
// instants in ascending order and their whitening in 1/m. The whitening does not know the
// plane and is chosen by the caller: 1 / (sigma_range |n . beam|), n the plane's normal in the
// scanner frame, makes e_i the range residual in standard deviations.
//
// offsets: of the points, whitened: e_i = w_i (x_i, y_i, 1) . g(t_i) + offsets_i; empty: none.
//
// Rows of U that can not matter are left out: with g_1 bounded by (1, 1, 100 m), rotation
// rates by 10 rad/s, speeds by 10 m/s and accelerations by 100 rad/s^2 and 100 m/s^2, what is
// left out changes the root of |U g|^2 by less than 1e-3 standard deviations of one range.
//
// nodes: the segment's own first, middle and last instant (to 1 ns), or those of a longer span
// around it, such that segments taken together share the poses at their nodes.
SegmentMeasurement CompressSegment(const Eigen::Matrix2Xd& points_scanner,
                                   const std::vector<int64_t>& times_ns,
                                   const Eigen::VectorXd& whitening,
                                   const Eigen::VectorXd& offsets,
                                   const std::array<int64_t, 3>& nodes_ns);
SegmentMeasurement CompressSegment(const Eigen::Matrix2Xd& points_scanner,
                                   const std::vector<int64_t>& times_ns,
                                   const Eigen::VectorXd& whitening,
                                   const Eigen::VectorXd& offsets = {});

// First, middle and last instant of a span, equally far from each other (to 1 ns).
std::array<int64_t, 3> NodesOfSpan(int64_t first_ns, int64_t last_ns);

// Where a node lies on the spline: it uses the control points first .. first + 3, counted from
// the factor's own first control point, at u in [0, 1).
struct SplineNode {
  int first = 0;
  double u = 0.0;
};

// Signed distances of one scan line segment to a plane, whitened.
//   r = weights.scale U g(q_0 .. q_{m-1}, p_0 .. p_{m-1}, body_from_scanner, plane)
//       + weights.offset b
// At most nine residuals, m = num_control_points between 4 and 6.
// Blocks: [ q_0 .. q_{m-1} | p_0 .. p_{m-1} | body_from_scanner q, t | plane ]
// g is differentiated automatically with respect to the pose at each node, the extrinsics and
// the plane; the chain rule through the spline follows in closed form. Jacobians of
// quaternions are those of unit quaternions: zero along q itself. sign is the horizontal
// plane's.
std::unique_ptr<ceres::CostFunction> CreateSegmentFactor(
    const SegmentMeasurement& measurement,
    const std::array<SplineNode, 3>& nodes,
    int num_control_points,
    PlaneModel model,
    double sign,
    const SegmentWeights& weights);

// g for the poses at the nodes.
Eigen::Matrix<double, 9, 1> SegmentGeometry(
    const std::array<SplinePose, 3>& poses,
    const Eigen::Quaterniond& body_from_scanner_rotation,
    const Eigen::Vector3d& body_from_scanner_translation,
    const Eigen::Vector3d& normal_world,
    double distance);

}  // namespace plumbline
