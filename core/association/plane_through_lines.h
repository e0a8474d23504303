#pragma once

#include <Eigen/Core>

#include "core/geometry/matrix_types.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"

namespace plumbline {

// A line that was measured on a surface.
struct MeasuredLine {
  Eigen::Vector3d centroid_world = Eigen::Vector3d::Zero();    // m
  Eigen::Vector3d direction_world = Eigen::Vector3d::UnitX();  // unit vector
  double sigma_offset_m = 0.0;                                 // at the centroid
  double sigma_direction_rad = 0.0;
  double flatness_m = 0.0;  // of the surface, the same for all lines at a place
};

// An observation's line. pose_covariance: of the body's rotation and position, world frame;
// flatness_m: of the surface, see AssociationOptions.
MeasuredLine MeasureLine(const Observation& observation,
                         const ObservationPoses& poses,
                         const Matrix6d& pose_covariance,
                         double flatness_m);

// The plane that fits measured lines best, of any direction: a weighted total least squares
// fit (the eigenvectors of the lines' moments), which needs no approximate plane to start
// from. A line counts as two points on it, whose distances from the plane have the line's
// offset and direction and their standard deviations.
class PlaneThroughLines {
 public:
  void Add(const MeasuredLine& line);

  int num_lines() const { return num_lines_; }

  // The plane through the lines taken in. CHECKs that there is one.
  struct Fit {
    Eigen::Vector3d centre_world;       // their weighted mean: the plane goes through it
    Eigen::Vector3d normal;             // of either sign
    Eigen::Matrix3d normal_covariance;  // rad^2; huge about a line that stands alone
    double centre_variance;             // m^2, along the normal
    double chi2;                        // of 2 num_lines - 3 degrees of freedom
  };
  Fit Solve() const;

 private:
  int num_lines_ = 0;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();  // the first line's centroid
  double flatness_m_ = 0.0;
  double weight_ = 0.0;
  Eigen::Vector3d first_moments_ = Eigen::Vector3d::Zero();  // about the origin
  Eigen::Matrix3d second_moments_ = Eigen::Matrix3d::Zero();
};

}  // namespace plumbline
