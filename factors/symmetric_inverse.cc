#include "factors/symmetric_inverse.h"

#include <glog/logging.h>

#include <cmath>

namespace plumbline {

// Sweeping a_kk exchanges the roles of variable k and its equation; with all of them swept,
// the matrix is the negative of its inverse.
std::optional<Eigen::MatrixXd> SymmetricInverse(const Eigen::MatrixXd& lower) {
  CHECK_EQ(lower.rows(), lower.cols());
  const Eigen::Index size = lower.rows();
  if (!(lower.diagonal().array() > 0.0).all()) return std::nullopt;
  // Scaled to a unit diagonal, so that metres and radians do not spoil the condition.
  const Eigen::VectorXd scale = lower.diagonal().cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd swept = scale.asDiagonal() * lower * scale.asDiagonal();
  Eigen::VectorXd column(size);
  Eigen::VectorXd scaled(size);
  for (Eigen::Index k = 0; k < size; ++k) {
    const double pivot = swept(k, k);
    if (!(pivot > 0.0)) return std::nullopt;
    const Eigen::Index after = size - k - 1;
    column.head(k) = swept.row(k).head(k).transpose();
    column[k] = 0.0;
    column.tail(after) = swept.col(k).tail(after);
    scaled = column / pivot;
    for (Eigen::Index j = 0; j < size; ++j) {
      swept.col(j).tail(size - j) -= scaled[j] * column.tail(size - j);
    }
    swept.row(k).head(k) = scaled.head(k).transpose();
    swept(k, k) = -1.0 / pivot;
    swept.col(k).tail(after) = scaled.tail(after);
  }
  swept = -(scale.asDiagonal() * swept * scale.asDiagonal()).eval();
  swept.triangularView<Eigen::StrictlyUpper>() = swept.transpose();
  return swept;
}

}  // namespace plumbline
