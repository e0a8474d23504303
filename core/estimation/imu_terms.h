#pragma once

#include <Eigen/Core>
#include <optional>

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

// ImuDifference is what the map's motion over some knot intervals has more than the readings
// of the IMU sum up to, as it is estimated: of the turn (rad) and of the change of velocity
// (m/s), along the world's axes, with the variances that the readings' white noise gives them
// by axis.
//
// What the spline does not follow between knots, a step or a vibration, it does not take for
// true either: it makes single readings uncertain, but not their sum.
struct ImuDifference {
  Eigen::Vector3d turn_world = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_world = Eigen::Vector3d::Zero();
  double turn_variance = 0.0;
  double velocity_variance = 0.0;

  // Takes in the difference over other knot intervals.
  ImuDifference& operator+=(const ImuDifference& other);
};

// Sums over the knot intervals first .. end - 1; nothing where readings are missing or at the
// end of their range. For a rig with an IMU that does not move in the plane.
std::optional<ImuDifference> DifferenceFromImu(const MapState& state, int first, int end);

// Returns the options for a rig whose IMU measures its accelerations: a prior 30 times weaker
// than that of any rig bends no motion. One that fits the motion shrinks it by some
// thousandths, which the IMU's scales would take for theirs.
MapperOptions WithoutMotionPrior(MapperOptions options);

// Means of readings in a knot interval.
inline constexpr int kImuMeansPerInterval = 2;

}  // namespace plumbline
