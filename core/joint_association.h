#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "core/landmark.h"
#include "core/mapper_options.h"

namespace plumbline {

// A landmark that one of a scan's observations may belong to, linearised at the predicted
// poses: its deviation from the landmark is value + by_motion * e + noise, e being the error
// of the prediction.
struct Pairing {
  int observation_index = 0;
  int landmark_id = 0;
  Eigen::Vector2d value = Eigen::Vector2d::Zero();  // LineDeviation: m, rad
  Eigen::Matrix2d noise = Eigen::Matrix2d::Identity();
  Eigen::Matrix2Xd by_motion;
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
// clutter: uniform within options.max_gap_m and over all directions. Returns indices into
// pairings.
std::vector<size_t> ChooseJointly(const std::vector<Pairing>& pairings,
                                  const Eigen::MatrixXd& covariance,
                                  const AssociationOptions& options);

}  // namespace plumbline
