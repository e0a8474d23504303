#include "factors/schur.h"

#include <glog/logging.h>

#include <Eigen/Eigenvalues>
#include <cmath>

namespace plumbline {
namespace {

// Eigenvectors of the eigenvalues above the tolerance, and these eigenvalues' square roots.
struct RangeBasis {
  Eigen::MatrixXd vectors;
  Eigen::VectorXd roots;
};

RangeBasis FindRange(const Eigen::MatrixXd& matrix, double tolerance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  CHECK_EQ(solver.info(), Eigen::Success) << "normal matrix with entries that are not finite";
  const Eigen::VectorXd& values = solver.eigenvalues();  // ascending
  const Eigen::Index size = values.size();
  const double indefinite = -100.0 * std::max(tolerance, 1e-13 * static_cast<double>(size));
  CHECK_GE(values[0], indefinite) << "normal matrix is not positive semi-definite";
  Eigen::Index rank = 0;
  while (rank < size && values[size - 1 - rank] > tolerance) ++rank;
  return {solver.eigenvectors().rightCols(rank), values.tail(rank).cwiseSqrt()};
}

}  // namespace

MarginalisedSystem Marginalise(const Eigen::MatrixXd& hessian,
                               const Eigen::VectorXd& gradient,
                               int num_marginalised,
                               double relative_tolerance) {
  const Eigen::Index num_kept = hessian.rows() - num_marginalised;
  CHECK_EQ(hessian.rows(), hessian.cols());
  CHECK_EQ(hessian.rows(), gradient.size());
  CHECK_GE(num_marginalised, 0);
  CHECK_GE(num_kept, 1);

  // Unit diagonal: metres and radians become comparable, and rounding errors of the reduced
  // matrix are then of the size of epsilon itself.
  const Eigen::VectorXd scale = hessian.diagonal().unaryExpr(
      [](double value) { return value > 0.0 ? 1.0 / std::sqrt(value) : 1.0; });
  const Eigen::MatrixXd scaled = scale.asDiagonal() * hessian * scale.asDiagonal();
  const Eigen::VectorXd scaled_gradient = scale.cwiseProduct(gradient);

  MarginalisedSystem system;
  Eigen::MatrixXd reduced = scaled.bottomRightCorner(num_kept, num_kept);
  Eigen::VectorXd reduced_gradient = scaled_gradient.tail(num_kept);
  if (num_marginalised > 0) {
    const RangeBasis range = FindRange(
        scaled.topLeftCorner(num_marginalised, num_marginalised), relative_tolerance);
    system.marginalised_rank = static_cast<int>(range.roots.size());
    // H_mm^+ = W W^T.
    const Eigen::MatrixXd half_inverse =
        range.vectors * range.roots.cwiseInverse().asDiagonal();
    const Eigen::MatrixXd coupling =
        half_inverse.transpose() * scaled.topRightCorner(num_marginalised, num_kept);
    reduced.noalias() -= coupling.transpose() * coupling;
    reduced_gradient.noalias() -=
        coupling.transpose() *
        (half_inverse.transpose() * scaled_gradient.head(num_marginalised));
  }

  const RangeBasis range = FindRange(reduced, relative_tolerance);
  system.rank = static_cast<int>(range.roots.size());
  // Row i of S is sqrt(lambda_i) v_i^T, so that S^T S = V Lambda V^T; undo the scaling.
  system.root = range.roots.asDiagonal() * range.vectors.transpose() *
                scale.tail(num_kept).cwiseInverse().asDiagonal();
  system.offset =
      range.roots.cwiseInverse().asDiagonal() * (range.vectors.transpose() * reduced_gradient);
  return system;
}

}  // namespace plumbline
