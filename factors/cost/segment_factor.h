#pragma once

#include <array>
#include <memory>

#include "factors/manifold/plane_model.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/spline.h"

namespace ceres {
class CostFunction;
}

namespace plumbline {

// Signed distances of one scan line segment to a plane, whitened, differentiated
// automatically: the formula that SegmentGroup has in closed form for many segments together.
//   r = weights.scale U g(q_0 .. q_{m-1}, p_0 .. p_{m-1}, body_from_scanner, plane)
//       + weights.offset b
// At most nine residuals, m = num_control_points between 4 and 6.
// Blocks: [ q_0 .. q_{m-1} | p_0 .. p_{m-1} | body_from_scanner q, t | plane ]
// g, of each node of the segment's scan line: the x and y axes of the scanner along the
// normal, and the signed distance of its origin (SegmentMeasurement). On a cylinder the plane
// is that which stands for it near the segment's centroid, and the residuals gain the bow of
// the segment, k level^2 c, with the share of the segment's direction that is level; that it
// becomes flatter as the rig tilts is of second order and not differentiated. chart: what of
// the plane's parametrisation is constant.
std::unique_ptr<ceres::CostFunction> CreateSegmentFactor(
    const SegmentMeasurement& measurement,
    const std::array<SplineNode, 3>& nodes,
    int num_control_points,
    PlaneModel model,
    const PlaneChart& chart,
    const SegmentWeights& weights);

}  // namespace plumbline
