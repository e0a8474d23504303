#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "core/map/landmark.h"
#include "core/options/mapper_options.h"

namespace plumbline {

// How far the rig's poses in one scan may be from their prediction: the errors of the poses at
// its beginning and its end (each: rotation in rad and position in m, world frame), between
// which they pass linearly.
using MotionError = Eigen::Matrix<double, 12, 1>;
using MotionCovariance = Eigen::Matrix<double, 12, 12>;

// Derivative of the pose's error at a share of the scan's duration by the motion's error.
Eigen::Matrix<double, 6, 12> PoseByMotion(double share);

// Covariance of that pose's error.
Eigen::Matrix<double, 6, 6> PoseCovariance(const MotionCovariance& covariance, double share);

// A landmark that one of a scan's observations may belong to, linearised at the predicted
// poses: its deviation from the landmark is value + by_motion * e + noise, e being the
// motion's error.
struct JointHypothesis {
  int observation_index = 0;
  int landmark_id = 0;
  Eigen::Vector2d value = Eigen::Vector2d::Zero();  // LineDeviation: m, rad
  Eigen::Matrix2d noise = Eigen::Matrix2d::Identity();
  Eigen::Matrix<double, 2, 12> by_motion = Eigen::Matrix<double, 2, 12>::Zero();
};

// -2 ln of the density of an observation without landmark: uniform within options.max_gap_m
// and over all directions.
double ClutterCost(const AssociationOptions& options);

struct JointChoice {
  std::vector<size_t> hypotheses;  // indices
  double cost = 0.0;               // -2 ln of the likelihood of all observations with pairings
};

// Chooses, among the pairings of one scan, at most one for each observation such that all of
// them agree with one and the same error of the prediction (covariance: its prior). Tested one
// by one they would not have to: where the prediction is poor, every clutter segment finds
// some landmark within its gate, and the wrong ones pull the pose away.
//
// The pairings are grouped by observation, the weightiest observation first. Each pairing of
// the first observations is tried as a start; from there the observations are taken in turn,
// each with its most probable landmark, and the error is estimated anew (Kalman update). The
// chain of largest likelihood wins, where an observation without landmark has the density of
// clutter.
JointChoice ChooseJointly(const std::vector<JointHypothesis>& hypotheses,
                          const MotionCovariance& covariance,
                          const AssociationOptions& options);

}  // namespace plumbline
