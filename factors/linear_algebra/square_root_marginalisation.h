#pragma once

#include <Eigen/Core>
#include <vector>

namespace plumbline {

// The kept variables' part of a least squares problem as a square root:
//   |offset + root x|^2 = min over the marginalised y of |r + J (y, x)|^2  - constant.
struct MarginalisedSystem {
  Eigen::MatrixXd root;    // S, rank x kept, S^T S = Schur complement
  Eigen::VectorXd offset;  // r0, rank, S^T r0 = reduced gradient
  // The kept variables as they were eliminated: row i of the root is zero in the first i.
  std::vector<int> order;
  int rank = 0;  // of the kept part: directions the measurements say something about
  int marginalised_rank = 0;  // of the marginalised part; less than its size: a free direction
                              // of it was left out, which is exact when it was free before
};

// Schur complement of the normal matrix H = J^T J and gradient g = J^T r, ordered
// [ marginalised | kept ], onto the kept variables, by Cholesky's elimination with pivoting.
// Only the lower triangle of H is read; H must be positive semi-definite: throws
// std::runtime_error when it is clearly indefinite or not finite, as of an estimate that has
// gone astray. A variable counts as free when, with all variables scaled to unit
// information (unit diagonal of H), less than relative_tolerance of it remains after those
// before it.
MarginalisedSystem Marginalise(const Eigen::MatrixXd& hessian,
                               const Eigen::VectorXd& gradient,
                               int num_marginalised,
                               double relative_tolerance = 1e-11);

}  // namespace plumbline
