#pragma once

#include <Eigen/Core>

#include "core/map/landmark.h"
#include "core/map/landmark_view.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"

namespace plumbline {

// How far an observed line deviates from a plane: signed distance at the centroid (m) and its
// change along the tangent (rad), estimated from the compressed beams, with their covariance.
struct LineDeviation {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  Eigen::Matrix<double, 2, 6> by_pose;  // world-frame rotation, position at the middle node
  Eigen::Matrix2d by_plane;             // landmark parameters
  double chi2 = 0.0;                    // of all the whitened residuals, deviation included
};

LineDeviation DeviationFromPlane(const Observation& observation,
                                 const ObservationPoses& poses,
                                 const LandmarkView& plane);

}  // namespace plumbline
