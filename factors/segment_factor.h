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
//   sum_i e_i^2 = |U g|^2,   g = (g_0, g_1, g_2).
struct SegmentMeasurement {
  // First instant, middle and last instant (to 1 ns) of the segment's points. A segment whose
  // points were all taken within 1 ns has num_nodes = 1: its nodes coincide and only g_0
  // counts.
  std::array<int64_t, 3> node_times_ns{};
  int num_nodes = 3;
  Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor, 9, 9> root;  // U
  int num_points = 0;
};

// Compresses the points (scanner frame, m; measured positions, motion not removed) with their
// instants in ascending order and their whitening in 1/m. The whitening does not know the
// plane and is chosen by the caller: 1 / (sigma_range |n . beam|), n the plane's normal in the
// scanner frame, makes e_i the range residual in standard deviations.
//
// Rows of U that can not matter are left out: with g_1 bounded by (1, 1, 100 m), rotation
// rates by 10 rad/s, speeds by 10 m/s and accelerations by 100 rad/s^2 and 100 m/s^2, what is
// left out changes the root of |U g|^2 by less than 1e-3 standard deviations of one range.
SegmentMeasurement CompressSegment(const Eigen::Matrix2Xd& points_scanner,
                                   const std::vector<int64_t>& times_ns,
                                   const Eigen::VectorXd& whitening);

// Where a node lies on the spline: it uses the control points first .. first + 3, counted from
// the factor's own first control point, at u in [0, 1).
struct SplineNode {
  int first = 0;
  double u = 0.0;
};

// Signed distances of one scan line segment to a plane, whitened.
//   r = weight_scale U g(q_0 .. q_{m-1}, p_0 .. p_{m-1}, body_from_scanner, plane)
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
    double weight_scale);

// g for the poses at the nodes: |root * g|^2 is the segment's chi-squared on the plane.
Eigen::Matrix<double, 9, 1> SegmentGeometry(
    const std::array<SplinePose, 3>& poses,
    const Eigen::Quaterniond& body_from_scanner_rotation,
    const Eigen::Vector3d& body_from_scanner_translation,
    const Eigen::Vector3d& normal_world,
    double distance);

}  // namespace plumbline
