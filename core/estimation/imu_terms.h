#pragma once

#include <Eigen/Core>

#include "core/estimation/block_layout.h"
#include "core/map/map_state.h"
#include "core/options/mapper_options.h"

namespace plumbline {

class EstimationProblem;

// Adds what the IMU has read in the knot intervals first .. end - 1 (each has the number of
// its first control point), and the random walks of the biases from nodes that begin in them.
// Nothing where there is no IMU. Where IMU and biases are held, the readings' deviations have
// what is uncertain of them as well, as much as errors that are the same in `num_alike`
// readings add.
void AddImu(
    const MapState& state, int first, int end, int num_alike, EstimationProblem* problem);

// Adds what the rig file says of the IMU and of its biases at the start.
void AddImuPrior(const ImuEstimate& imu, EstimationProblem* problem);

// Takes the covariance of a block of the IMU or its biases from this row on of a joint one.
void SetImuCovariance(const BlockId& block,
                      const Eigen::MatrixXd& covariance,
                      Eigen::Index row,
                      ImuEstimate* imu);

// Returns the options for a rig whose IMU measures its accelerations: a prior 30 times weaker
// than that of any rig bends no motion. One that fits the motion shrinks it by some
// thousandths, which the IMU's scales would take for theirs.
MapperOptions WithoutMotionPrior(MapperOptions options);

// Means of readings in a knot interval.
inline constexpr int kImuMeansPerInterval = 2;

}  // namespace plumbline
