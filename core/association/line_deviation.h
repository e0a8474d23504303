#pragma once

#include <Eigen/Core>

#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/surface/landmark.h"
#include "core/surface/landmark_view.h"

namespace plumbline {

// The deviation of an observed line from a surface, a plane or an arc that bends as the
// surface does: the signed distance at the centroid (m) and its change along the tangent
// (rad), estimated from the compressed beams, and their covariance.
struct LineDeviation {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  Eigen::Matrix<double, 2, 6> by_pose;   // world-frame rotation, position at the middle node
  Eigen::Matrix<double, 2, 3> by_plane;  // landmark parameters
  double chi2 = 0.0;                     // of all the whitened residuals, deviation included
};

// The deviation of an observed line with the bow that it shows beyond the surface's: offset
// (m), slope (rad) and curvature (1/m) along the segment, as normal equations.
struct BowedDeviation {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_side = Eigen::Vector3d::Zero();
  Eigen::Matrix3d by_surface;  // of the three, by the parameters of a cylinder
};

// surface: a cylinder; its curvature may be zero.
BowedDeviation BowedDeviationFrom(const Observation& observation,
                                  const ObservationPoses& poses,
                                  const LandmarkView& surface);

// Estimates the deviation of an observation's line from a surface.
LineDeviation DeviationFromPlane(const Observation& observation,
                                 const ObservationPoses& poses,
                                 const LandmarkView& surface);

}  // namespace plumbline
