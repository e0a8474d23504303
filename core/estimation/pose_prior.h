#pragma once

#include <vector>

#include "core/estimation/estimation_problem.h"
#include "core/estimation/map_covariance.h"
#include "core/estimation/normal_equations.h"
#include "core/trajectory/gravity_start.h"
#include "core/trajectory/pose_gaussian.h"
#include "core/trajectory/trajectory.h"

namespace plumbline {

// Rows of the control points from `first` on in equations, as they stand in a PoseGaussian
// with six rows for each: rotation and position; a planar rotation is a yaw, the third row.
std::vector<int> RowsInPoses(const NormalEquations& equations, int first);

// The equations' Hessian on the control points from `first` on, all other unknowns left out,
// as a Gaussian about the control points' present values.
PoseGaussian PosesFrom(const NormalEquations& equations,
                       const Eigen::MatrixXd& information,
                       const Trajectory& trajectory,
                       int first);

// The Gaussian as a square-root prior on the control points' blocks. Throws Error where it
// leaves one of them open.
Prior PosePrior(const PoseGaussian& gaussian, bool planar);

// Adds what gravity tells of the first pose, and how fast the rig may go then.
void AddGravityStart(const GravityStart& start,
                     const Trajectory& trajectory,
                     EstimationProblem* problem);

// Adds what the rig file says of the estimated scanners.
void AddScannerPriors(const RigCalibration& calibration, EstimationProblem* problem);

// Takes the covariances of scanners, IMU and its biases from that of the problem's map.
void SetCalibrationCovariance(const EstimationProblem& problem,
                              const MapCovariance& covariance,
                              RigCalibration* calibration);

}  // namespace plumbline
