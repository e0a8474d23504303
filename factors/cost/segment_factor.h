#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "factors/manifold/plane_model.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/spline.h"

namespace ceres {
class CostFunction;
}

namespace plumbline {

// Signed distances of one scan line segment to a plane, whitened.
//   r = weights.scale U g(q_0 .. q_{m-1}, p_0 .. p_{m-1}, body_from_scanner, plane)
//       + weights.offset b
// At most nine residuals, m = num_control_points between 4 and 6.
// Blocks: [ q_0 .. q_{m-1} | p_0 .. p_{m-1} | body_from_scanner q, t | plane ]
// On a cylinder g is that of the plane which stands for it near the segment's centroid, and
// the residuals gain the bow of the segment, k level^2 c (SegmentMeasurement), with the share
// of the segment's direction that is level. g is differentiated automatically with respect to
// the pose at each node, the extrinsics and the plane; the chain rule through the spline
// follows in closed form. Jacobians of quaternions are those of unit quaternions: zero along q
// itself. chart: what of the plane's parametrisation is constant.
std::unique_ptr<ceres::CostFunction> CreateSegmentFactor(
    const SegmentMeasurement& measurement,
    const std::array<SplineNode, 3>& nodes,
    int num_control_points,
    PlaneModel model,
    const PlaneChart& chart,
    const SegmentWeights& weights);

// g for the poses at the nodes.
Eigen::Matrix<double, 9, 1> SegmentGeometry(
    const std::array<SplinePose, 3>& poses,
    const Eigen::Quaterniond& body_from_scanner_rotation,
    const Eigen::Vector3d& body_from_scanner_translation,
    const Eigen::Vector3d& normal_world,
    double distance);

}  // namespace plumbline
