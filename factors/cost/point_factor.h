#pragma once

#include <Eigen/Core>
#include <memory>

#include "factors/manifold/plane_model.h"

namespace ceres {
class CostFunction;
}

namespace plumbline {

struct PointMeasurement {
  Eigen::Vector2d point_scanner = Eigen::Vector2d::Zero();  // m, in the scan plane
  double u = 0.0;          // place in the knot interval, [0, 1)
  double whitening = 1.0;  // 1 / standard deviation of the signed distance, 1/m
  double offset = 0.0;     // whitened; see SegmentMeasurement
};

// Whitened signed distance of one laser point to a plane, differentiated automatically.
//   r = whitening ( n . (R(u) (R_bs s + t_bs) + p(u)) - d ) + offset,   s = (x, y, 0)
// To first order r is the range residual when whitening = 1 / (sigma_range |n . beam|).
// Blocks: [ q0 q1 q2 q3 | p0 p1 p2 p3 | body_from_scanner q, t | plane ]
// chart: what of the plane's parametrisation is constant.
std::unique_ptr<ceres::CostFunction> CreatePointFactor(const PointMeasurement& measurement,
                                                       PlaneModel model,
                                                       const PlaneChart& chart);

}  // namespace plumbline
