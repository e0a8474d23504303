#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "core/estimation/arrowhead_equations.h"
#include "core/estimation/block_layout.h"
#include "core/estimation/estimation_problem.h"
#include "core/estimation/normal_equations.h"

namespace plumbline {

// Normal equations of an estimation problem at its current values, its terms' losses included
// by their first derivative. Held directions have zero rows and columns in the dense form, a
// unit diagonal in the block arrowhead form.
NormalEquations LineariseDense(const EstimationProblem& problem, const BlockLayout& layout);
ArrowheadEquations LineariseArrowhead(const EstimationProblem& problem,
                                      const BlockLayout& layout);

// Number of control points of a tile of the block arrowhead form. Those of a residual lie in
// two adjacent tiles, so one more is the most that it may have: a group of segments of the
// batch has nine and begins at every fourth. With an IMU a tile ends with a node's biases:
// readings depend on those of two neighbouring nodes.
inline constexpr int kTileControlPoints = 8;

// Number of linearisations that the problem's groups of segments have gone through so far: it
// stands still while everything moves within what their linearisations hold for.
int NumGroupLinearisations(const EstimationProblem& problem);

// Visits the factor terms of a kind at the problem's current values: (columns in the layout,
// ascending; dense Jacobian on them; residuals).
using ResidualVisitor = std::function<void(
    const std::vector<int>&, const Eigen::MatrixXd&, const Eigen::VectorXd&)>;
void VisitFactors(const EstimationProblem& problem,
                  const BlockLayout& layout,
                  std::optional<FactorTerm::Kind> kind,  // none: all of them
                  const ResidualVisitor& visit);

}  // namespace plumbline
