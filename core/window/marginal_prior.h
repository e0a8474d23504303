#pragma once

#include <Eigen/Core>
#include <deque>
#include <map>
#include <vector>

#include "core/estimation/estimation_problem.h"
#include "core/estimation/normal_equations.h"
#include "core/surface/landmark.h"

namespace plumbline {

// MarginalPrior is a quadratic cost on some blocks about the values they had, in
// coordinates in which it stays one while they move. A plane that has been seen for a moment
// may still turn by degrees: vertical landmarks are kept anchored where they were first seen
// (factors/manifold/anchored_plane.h).
struct MarginalPrior {
  NormalEquations equations;
  std::vector<Eigen::VectorXd> at;  // parallel to equations.blocks

  MarginalPrior() { equations.offsets.assign(1, 0); }
};

// Returns the point that a landmark is anchored at: x, y of the world. Zero for the gauge's
// wall, which does not turn.
Eigen::Vector2d AnchorOf(const Landmark& landmark);

// Converts a landmark's parameters to the marginal prior's coordinates, and back; d parameters
// / d prior's coordinates where it is now.
Eigen::VectorXd AnchoredParameters(const Landmark& landmark);
void SetFromAnchored(const Eigen::VectorXd& anchored, Landmark* landmark);
Eigen::MatrixXd ParametersByAnchored(const Landmark& landmark);
// Sets the covariance of its parameters from that of the marginal prior's coordinates.
void SetCovarianceFromAnchored(const Eigen::MatrixXd& covariance, Landmark* landmark);

// Turns equations about the landmarks' parameters, where they are now, into the marginal
// prior's coordinates; and a covariance of such equations' rows.
void EquationsToAnchored(const std::deque<Landmark>& landmarks, NormalEquations* equations);
void CovarianceToAnchored(const std::deque<Landmark>& landmarks,
                          const NormalEquations& equations,
                          Eigen::MatrixXd* covariance);

// Reanchoring relates a plane's coordinates to those of the plane that it has become.
struct Reanchoring {
  Eigen::VectorXd shift;    // they were measured from values smaller by this
  Eigen::MatrixXd by_into;  // their derivative by the other plane's
};

// Makes the plane `from` of the marginal prior the plane `into`, each with its own anchor:
// about the value that the marginal prior has for `into`, else about that for `from`. Exact to
// first order in how far the plane is from there, however far the two have turned.
Reanchoring MergePlanes(const Landmark& into, const Landmark& from, MarginalPrior* prior);

}  // namespace plumbline
