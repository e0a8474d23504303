#pragma once

#include <Eigen/Core>

namespace plumbline {

// By what to multiply a step of Gauss-Newton so that it ends where the steps after it would
// (Aitken's extrapolation). Where residuals are large against what is known of a direction, as
// where a wrong association holds a pose, each step along it takes the same small share of the
// way.
//
// last_step: the step before, without the last_lengthening that it was taken with; weights: of
// the unknowns' squares. At least one, and at most 20; one where the steps have different
// directions or this one is less than half as long.
double AitkenRelaxation(const Eigen::VectorXd& step,
                        const Eigen::VectorXd& last_step,
                        double last_lengthening,
                        const Eigen::VectorXd& weights);

}  // namespace plumbline
