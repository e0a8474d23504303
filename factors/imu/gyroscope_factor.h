#pragma once

#include <memory>

#include "factors/imu/imu_block.h"

namespace ceres {
class CostFunction;
}

namespace plumbline {

// Angular rates that a gyroscope has read, in its own frame:
//   r = ( (1 + scale) o Q^T w + bias - measured ) / stddev                       3 residuals
// with the body's angular rate w in the body frame, the mean over the measurement's two
// instants, Q = Exp(turn) body_from_imu and o the product axis by axis.
// Blocks: [ rotation x 4 | IMU (imu_block.h) | bias | next bias (rad/s) ].
std::unique_ptr<ceres::CostFunction> CreateGyroscopeFactor(const ImuMeasurement& measurement,
                                                           const ImuPose& stated,
                                                           double knot_interval_s);

}  // namespace plumbline
