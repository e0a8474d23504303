#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/association.h"
#include "core/map_state.h"
#include "core/mapper_options.h"
#include "core/observation_groups.h"
#include "core/rig.h"
#include "core/trajectory.h"

namespace plumbline {

// A Gaussian on consecutive control points about the values they had. Rows: 6 for each control
// point, rotation (rad, world frame) and position (m); for planar rigs the rows of roll, pitch
// and height are zero.
struct PoseGaussian {
  int first = 0;
  std::vector<ControlPoint> mean;
  Eigen::MatrixXd information;

  int end() const { return first + static_cast<int>(mean.size()); }
};

// Joint covariance of the newest control points, from which that of a pose follows.
class PoseUncertainty {
 public:
  PoseUncertainty() = default;
  PoseUncertainty(int first, Eigen::MatrixXd covariance)
      : first_(first), covariance_(std::move(covariance)) {}

  // World-frame rotation (rad) and position (m) of the body.
  Matrix6d At(const Trajectory& trajectory, int64_t time_ns) const;
  // Derivative of the pose by the control points, in the columns of covariance().
  Eigen::MatrixXd JacobianAt(const Trajectory& trajectory, int64_t time_ns) const;
  const Eigen::MatrixXd& covariance() const { return covariance_; }

 private:
  // The control points that a pose depends on: first column, derivative.
  struct Local {
    Eigen::Index column = 0;
    Eigen::Matrix<double, 6, 24> jacobian;
  };
  Local LocalJacobian(const Trajectory& trajectory, int64_t time_ns) const;

  int first_ = 0;  // control point of the first six rows
  Eigen::MatrixXd covariance_;
};

// The light step of every scan: estimates the newest control points alone, the planes given,
// by Gauss-Newton on some 24 unknowns. Its prior comes from the window (Reset) and takes in
// scan after scan until the window is solved again.
class Tracker {
 public:
  Tracker(const Rig& rig, bool planar, const MapperOptions& options, MapState* state);

  // Associates the observations first .. last of the newest scan with the candidates and
  // estimates its poses, in turn until the associations stand.
  void Track(int first_observation,
             int last_observation,
             const std::vector<LandmarkCandidate>& candidates);

  // An observation that was given a landmark after its scan had been tracked.
  void Add(int observation_index) { recent_.push_back(observation_index); }

  // What the window knows of the newest control points.
  void Reset(PoseGaussian gaussian);

  // Uncertainty of the newest poses, the planes given.
  const PoseUncertainty& pose_uncertainty() const { return pose_uncertainty_; }

 private:
  struct System;
  struct Term;

  // How the rig's poses in a scan differ from their prediction: by errors of the control
  // points, and where `unsteady` by what a spline of these knots can not follow.
  struct Association {
    std::vector<std::pair<int, int>> chosen;  // observation index, landmark id
    bool unsteady = false;
  };

  int first() const { return gaussian_.mean.empty() ? 0 : gaussian_.first; }
  std::vector<int> FreeRows(Eigen::Index size) const;
  Eigen::MatrixXd Covariance(const Eigen::MatrixXd& information) const;
  std::vector<Term> MotionTerms() const;
  System Linearise(const std::vector<Term>& terms,
                   const std::vector<ObservationGroup>& groups) const;
  std::vector<ControlPoint> ControlPoints() const;
  void Move(const std::vector<ControlPoint>& from, const Eigen::VectorXd& step);
  // Gauss-Newton from where the control points are; returns the system where they end.
  System Estimate(const std::vector<Term>& terms, const std::vector<ObservationGroup>& groups);
  std::vector<ObservationGroup> Groups(int first_observation, int last_observation) const;
  Association AssociateJointly(int first_observation,
                               int last_observation,
                               const std::vector<LandmarkCandidate>& candidates) const;
  // Finds the observations' landmarks one by one; true when any is another one than before.
  bool Associate(int first_observation,
                 int last_observation,
                 const std::vector<LandmarkCandidate>& candidates);

  const Rig& rig_;
  bool planar_;
  const MapperOptions& options_;
  MapState* state_;
  PoseGaussian gaussian_;    // from all scans so far, planes given; empty before the first
  std::vector<int> recent_;  // observations that gaussian_ does not know of
  PoseUncertainty pose_uncertainty_;
};

}  // namespace plumbline
