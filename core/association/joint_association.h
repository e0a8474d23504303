#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "core/options/mapper_options.h"
#include "core/surface/landmark.h"

namespace plumbline {

// The error of the rig's predicted motion in one scan: the errors of the poses at its
// beginning and its end (each: rotation in rad and position in m, world frame); between these
// the error passes linearly.
using MotionError = Eigen::Matrix<double, 12, 1>;
using MotionCovariance = Eigen::Matrix<double, 12, 12>;

// The derivative of the pose's error at a share of the scan's duration by the motion's error.
Eigen::Matrix<double, 6, 12> PoseByMotion(double share);

// The covariance of the pose's error at a share of the scan's duration.
Eigen::Matrix<double, 6, 6> PoseCovariance(const MotionCovariance& covariance, double share);

// A landmark that one of a scan's observations may lie on, linearised at the predicted poses:
// the observation's deviation from it is value + by_motion * e + noise, e being the motion's
// error.
struct JointHypothesis {
  int observation_index = 0;
  int landmark_id = 0;
  Eigen::Vector2d value = Eigen::Vector2d::Zero();  // LineDeviation: m, rad
  Eigen::Matrix2d noise = Eigen::Matrix2d::Identity();
  Eigen::Matrix<double, 2, 12> by_motion = Eigen::Matrix<double, 2, 12>::Zero();
};

// The cost, -2 ln of the density, of an observation without a landmark, which is uniform
// within options.max_gap_m and over all directions.
double ClutterCost(const AssociationOptions& options);

// The hypotheses chosen for the observations of a scan.
struct JointChoice {
  std::vector<size_t> hypotheses;  // indices
  double cost = 0.0;  // -2 ln of the likelihood of all observations that have hypotheses
};

// Chooses, among the hypotheses of one scan, at most one for each observation such that all of
// them agree with one and the same error of the prediction (covariance: its prior). Hypotheses
// tested one by one would not have to: where the prediction is poor, every clutter segment
// finds some landmark within its gate, and the wrong ones pull the pose away.
//
// The hypotheses are grouped by observation, the weightiest observation first. Each hypothesis
// of the first observations is tried as a start; from there the observations are taken in
// turn, each with its most probable landmark, and the error is estimated anew (Kalman update).
// The chain of largest likelihood wins, where an observation without landmark has the density
// of clutter.
JointChoice ChooseJointly(const std::vector<JointHypothesis>& hypotheses,
                          const MotionCovariance& covariance,
                          const AssociationOptions& options);

}  // namespace plumbline
