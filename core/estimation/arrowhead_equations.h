#pragma once

#include <Eigen/Core>

#include "core/estimation/arrowhead_matrix.h"

namespace plumbline {

// Normal equations of a whole recording's problem, in the batch's shape. Directions that are
// held have a unit diagonal and no gradient.
struct ArrowheadEquations {
  ArrowheadMatrix hessian;
  Eigen::VectorXd diagonal;  // of the hessian
  Eigen::VectorXd gradient;
  double cost = 0.0;
};

}  // namespace plumbline
