#pragma once

#include <Eigen/Core>
#include <optional>

namespace plumbline {

// Inverse of a positive definite matrix of some dozens of rows, of which only the lower
// triangle is read; nothing where it is not positive definite. By sweeps over the triangle: at
// this size faster than a blocked factorisation with a solution for the identity.
std::optional<Eigen::MatrixXd> SymmetricInverse(const Eigen::MatrixXd& lower);

}  // namespace plumbline
