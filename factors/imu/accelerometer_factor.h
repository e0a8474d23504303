#pragma once

#include <memory>

#include "factors/imu/imu_block.h"

namespace ceres {
class CostFunction;
}

namespace plumbline {

// Specific forces that an accelerometer has read, in its own frame; one at rest reads g
// upwards:
//   r = ( (1 + scale) o Q^T f + bias - measured ) / stddev                       3 residuals
//   f = R^T (p'' - gravity) + a x l + w x (w x l),   the mean over the measurement's instants
// with the body's rotation R, angular rate w and acceleration a in the body frame, the IMU's
// place l = t + shift in it, its attitude Q = Exp(turn) body_from_imu, o the product axis by
// axis, and gravity = Exp(lean) (0, 0, -gravity_m_s2) in the world.
// Blocks: [ rotation x 4 | position x 4 | IMU (imu_block.h) | bias | next bias (m/s^2) ].
std::unique_ptr<ceres::CostFunction> CreateAccelerometerFactor(
    const ImuMeasurement& measurement,
    const ImuPose& stated,
    double gravity_m_s2,
    double knot_interval_s);

}  // namespace plumbline
