#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/estimation/arrowhead_cholesky.h"
#include "core/estimation/arrowhead_equations.h"
#include "core/estimation/block_layout.h"
#include "core/estimation/correlated_errors.h"
#include "core/estimation/estimation_problem.h"
#include "core/geometry/matrix_types.h"
#include "core/trajectory/trajectory.h"

namespace plumbline {

// WeakDirection is a direction in which the estimation is weak.
struct WeakDirection {
  double eigenvalue = 0.0;  // of the normal matrix scaled to a unit diagonal
  BlockId block;            // the unknown that has the largest share in it
  double share = 0.0;       // of the squared length of the direction
};

// MapCovariance is the covariance of an estimate: of all planes together, and of the pose at
// any instant. Absolute, in the model frame; what the gauge holds has zero rows. For the range
// noise of the rig file, not scaled by the variance factor, and for the correlated errors that
// it is told of.
class MapCovariance {
 public:
  MapCovariance() = default;
  // Inverts the problem's normal equations: those at its current values, or others of
  // the same unknowns. Throws Error when they do not determine the unknowns.
  static MapCovariance Of(const EstimationProblem& problem);
  static MapCovariance Of(const EstimationProblem& problem, ArrowheadEquations equations);
  // Inverts the equations and adds the covariance of correlated errors, which `correlated`
  // estimates with the factorised equations.
  using CorrelatedErrorsOf = std::function<CorrelatedErrors(const ArrowheadCholesky&)>;
  static MapCovariance Of(const EstimationProblem& problem,
                          ArrowheadEquations equations,
                          const CorrelatedErrorsOf& correlated);
  // Of the poses alone, where surfaces and scanners are as they are estimated.
  static MapCovariance OfPoses(const EstimationProblem& problem);

  const std::vector<int>& landmark_ids() const { return landmark_ids_; }  // ascending
  // First row of each landmark's parameters; the last element is the size.
  const std::vector<int>& offsets() const { return offsets_; }
  const Eigen::MatrixXd& landmarks() const { return landmarks_; }

  // Joint covariance of the blocks of the estimated scanners, in the rig's order, and the IMU.
  const Eigen::MatrixXd& scanners() const { return scanners_; }

  // World-frame rotation (rad) and position (m) of the body.
  Matrix6d PoseAt(const Trajectory& trajectory, int64_t time_ns) const;

  // Position (m) of the body in the map turned about its origin so that the control points'
  // headings are right on the mean, weighted by their information, instead of the reference
  // wall's: what a turn of the whole map does to positions is not in it (an S-transformation,
  // Baarda 1973).
  Eigen::Matrix3d PositionInTurnedMap(const Trajectory& trajectory, int64_t time_ns) const;

  // Joint covariance of unknowns first .. first + size - 1 of the control points and biases,
  // in the problem's layout; of two neighbouring tiles at most, as everything one residual
  // depends on.
  Eigen::MatrixXd OfBand(int first, int size) const;

  // The smallest eigenvalues, ascending.
  const std::vector<WeakDirection>& weak_directions() const { return weak_directions_; }

 private:
  int NumRotations() const { return planar_ ? 1 : 3; }  // of a control point's unknowns
  // Sets the covariances with the mean heading.
  void RelateToHeading(const ArrowheadCholesky& factor,
                       const Eigen::VectorXd& information,
                       const Eigen::MatrixXd& shift,
                       int num_band);

  bool planar_ = false;
  BlockLayout layout_;
  std::vector<int> landmark_ids_;
  std::vector<int> offsets_;
  ArrowheadInverse inverse_;
  Eigen::VectorXd with_heading_;  // covariance of control points with their mean heading
  double heading_variance_ = 0.0;
  Eigen::MatrixXd shift_;  // of the control points by correlated errors; empty: none
  Eigen::MatrixXd landmarks_;
  Eigen::MatrixXd scanners_;
  std::vector<WeakDirection> weak_directions_;
};

}  // namespace plumbline
