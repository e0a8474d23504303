#include "factors/linear_algebra/elimination.h"

#include <glog/logging.h>

#include <cmath>

namespace plumbline {

std::optional<Elimination> Elimination::Make(const Eigen::MatrixXd& hessian,
                                             const Eigen::VectorXd& gradient,
                                             Eigen::Index num_eliminated) {
  const Eigen::Index m = num_eliminated;
  const Eigen::Index n = hessian.rows() - m;
  CHECK_EQ(hessian.rows(), hessian.cols());
  CHECK_EQ(hessian.rows(), gradient.size());
  CHECK(m >= 0 && n >= 0);
  Elimination result;
  // Scaled to a unit diagonal, so that metres and radians do not spoil the condition.
  result.scale_ = hessian.diagonal().head(m).unaryExpr(
      [](double value) { return value > 0.0 ? 1.0 / std::sqrt(value) : 0.0; });
  Eigen::MatrixXd leading =
      result.scale_.asDiagonal() * hessian.topLeftCorner(m, m) * result.scale_.asDiagonal();
  for (Eigen::Index i = 0; i < m; ++i) {
    if (result.scale_[i] == 0.0) leading(i, i) = 1.0;
  }
  result.factor_.compute(leading);
  if (m > 0 && result.factor_.info() != Eigen::Success) return std::nullopt;
  const auto lower = result.factor_.matrixL();
  result.half_ = result.scale_.asDiagonal() * hessian.bottomLeftCorner(n, m).transpose();
  result.half_gradient_ = result.scale_.cwiseProduct(gradient.head(m));
  if (m > 0) {
    lower.solveInPlace(result.half_);
    lower.solveInPlace(result.half_gradient_);
  }
  result.hessian_ = hessian.bottomRightCorner(n, n).selfadjointView<Eigen::Lower>();
  result.hessian_.noalias() -= result.half_.transpose() * result.half_;
  result.gradient_ = gradient.tail(n) - result.half_.transpose() * result.half_gradient_;
  return result;
}

Eigen::VectorXd Elimination::BackSubstitute(const Eigen::VectorXd& x) const {
  Eigen::VectorXd y = -(half_gradient_ + half_ * x);
  if (y.size() > 0) factor_.matrixU().solveInPlace(y);
  return scale_.cwiseProduct(y);
}

Eigen::MatrixXd Elimination::Gain() const {
  Eigen::MatrixXd gain = -half_;
  if (gain.rows() > 0) factor_.matrixU().solveInPlace(gain);
  return scale_.asDiagonal() * gain;
}

Eigen::MatrixXd Elimination::ConditionalRoot() const {
  Eigen::MatrixXd root = scale_.asDiagonal();
  if (root.rows() > 0) factor_.matrixL().solveInPlace(root);
  return root;
}

}  // namespace plumbline
