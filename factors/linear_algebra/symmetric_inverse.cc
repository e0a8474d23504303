#include "factors/linear_algebra/symmetric_inverse.h"

#include <glog/logging.h>

namespace plumbline {

// Sweeping a variable exchanges its role with that of its equation; with all variables swept,
// the matrix is the negative of its inverse.
std::optional<Eigen::MatrixXd> SymmetricInverse(const Eigen::MatrixXd& lower) {
  CHECK_EQ(lower.rows(), lower.cols());
  if (!(lower.diagonal().array() > 0.0).all()) return std::nullopt;
  // Scaled to a unit diagonal, so that metres and radians do not spoil the condition.
  const Eigen::VectorXd scale = lower.diagonal().cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd swept = scale.asDiagonal() * lower * scale.asDiagonal();
  Eigen::VectorXd column(lower.rows());
  for (Eigen::Index k = 0; k < swept.rows(); ++k) {
    const Eigen::Index below = swept.rows() - k;
    const double pivot = swept(k, k);
    if (!(pivot > 0.0)) return std::nullopt;
    column << swept.row(k).head(k).transpose(), swept.col(k).tail(below);
    column[k] = 0.0;
    swept.selfadjointView<Eigen::Lower>().rankUpdate(column, -1.0 / pivot);
    column /= pivot;
    column[k] = -1.0 / pivot;
    swept.row(k).head(k) = column.head(k).transpose();
    swept.col(k).tail(below) = column.tail(below);
  }
  Eigen::MatrixXd inverse = -(scale.asDiagonal() * swept * scale.asDiagonal());
  inverse.triangularView<Eigen::StrictlyUpper>() = inverse.transpose();
  return inverse;
}

}  // namespace plumbline
