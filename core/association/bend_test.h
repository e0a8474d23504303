#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/geometry/matrix_types.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/surface/landmark.h"
#include "core/surface/landmark_view.h"

namespace plumbline {

// Normal equations of a cylinder's parameters about a cylinder as it is now, by the offsets,
// slopes and bows of segments.
class CylinderEquations {
 public:
  // of_pose: the covariance of offset (m) and slope (rad) that comes from the pose;
  // flatness_m: of surfaces (AssociationOptions).
  void Add(const Observation& observation,
           const ObservationPoses& poses,
           const LandmarkView& cylinder,
           const Eigen::Matrix2d& of_pose,
           double flatness_m);

  struct Solution {
    Eigen::Vector3d step;
    Eigen::Matrix3d covariance;
    double mean_chi2;  // over the degrees of freedom, after the step
    // The step of the curvature by the bows of single segments alone, and its variance: they
    // know nothing of errors of the poses, which bend a wall that many scans saw.
    double curvature_by_bows;
    double variance_by_bows;
  };
  // Nothing where the segments leave the cylinder open.
  std::optional<Solution> Solve() const;

 private:
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_side_ = Eigen::Vector3d::Zero();
  double square_ = 0.0;
  double bow_information_ = 0.0;
  double bow_right_side_ = 0.0;
  int num_segments_ = 0;
};

// Whether the segments of a landmark may show that it bends, or that it does not: of a wall,
// or a cylinder that turns so little where it was seen that it may as well be a plane. The
// gauge's wall stays one.
bool MayBend(const Landmark& landmark);

// Whether a wall bends: the likelihood ratio of an upright cylinder and a plane through the
// same segments. Where they do not bend, or can not tell, the wall stays a plane, which has
// one unknown less.
class BendTest {
 public:
  // Of a surface that can not bend: it takes no segments.
  BendTest() = default;
  // wall: vertical, or a cylinder that hardly turns on its width; the result's chart is about
  // its anchor. flatness_m: of surfaces (AssociationOptions); range_noise_m: of the scanners.
  BendTest(const Landmark& wall, double flatness_m, double range_noise_m);

  void Add(const Observation& observation,
           const ObservationPoses& poses,
           const Matrix6d& pose_covariance);

  // The cylinder, its extent empty and its covariance for the poses given, where its curvature
  // is beyond doubt by the bows of single segments, and makes a bow that neither unevenness
  // does nor beams on what lies beside.
  std::optional<Landmark> Solve() const;

 private:
  // The width on which points spread evenly would spread as these segments do, m.
  double Width() const;

  std::optional<Landmark> reference_;  // not bent
  double flatness_m_ = 0.0;
  double range_noise_m_ = 0.0;
  CylinderEquations equations_;
  int num_points_ = 0;
  double along_ = 0.0;  // sums over points of their places along the wall, and of its square
  double along2_ = 0.0;
};

}  // namespace plumbline
