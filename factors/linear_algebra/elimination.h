#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <optional>

namespace plumbline {

// Elimination of the leading variables y of a quadratic cost in (y, x) that determines them,
// with the way back: what remains on x, and then y's minimum and covariance given x's.
//
//   cost = (y, x)^T H (y, x) / 2 + g . (y, x)
//
// Variables without information (zero diagonal: directions that are held) stay at zero.
class Elimination {
 public:
  // Eliminates the first num_eliminated variables; returns nothing where H does not determine
  // them. Only the lower triangle of H is read.
  static std::optional<Elimination> Make(const Eigen::MatrixXd& hessian,
                                         const Eigen::VectorXd& gradient,
                                         Eigen::Index num_eliminated);

  // The cost on x alone: Schur complement (full matrix) and reduced gradient.
  const Eigen::MatrixXd& hessian() const { return hessian_; }
  const Eigen::VectorXd& gradient() const { return gradient_; }

  // The minimum of y for this x.
  Eigen::VectorXd BackSubstitute(const Eigen::VectorXd& x) const;
  // cov(y) = conditional + gain cov(x) gain^T.
  Eigen::MatrixXd Gain() const;             // d y / d x
  Eigen::MatrixXd ConditionalRoot() const;  // M with M^T M = conditional covariance

 private:
  Elimination() = default;

  // The factorisation, with S = diag(scale): S H_yy S = L L^T, half = L^-1 S H_yx,
  // half_gradient = L^-1 S g_y.
  Eigen::VectorXd scale_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::MatrixXd half_;
  Eigen::VectorXd half_gradient_;
  Eigen::MatrixXd hessian_;
  Eigen::VectorXd gradient_;
};

}  // namespace plumbline
