#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace plumbline {

// Weights by which least squares minimises a robust loss, step by step (iteratively reweighted
// least squares: Holland and Welsch 1977). scale: of the loss, in the residual's unit.
inline double CauchyWeight(double residual, double scale) {
  const double ratio = residual / scale;
  return 1.0 / (1.0 + ratio * ratio);
}
inline double GemanMcClureWeight(double residual, double scale) {
  const double ratio = residual / scale;
  return 1.0 / ((1.0 + ratio * ratio) * (1.0 + ratio * ratio));
}
// 0 from the scale on.
inline double TukeyWeight(double residual, double scale) {
  const double ratio = residual / scale;
  if (ratio * ratio >= 1.0) return 0.0;
  return (1.0 - ratio * ratio) * (1.0 - ratio * ratio);
}

// RobustFit is one Gauss-Newton step of a fit of N parameters to residuals that count by
// weights: their normal equations.
template <int N>
class RobustFit {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  // deviation: of the parameters from the prior's mean.
  void AddPrior(const Matrix& information, const Vector& deviation) {
    hessian_ += information;
    gradient_ += information * deviation;
  }
  // jacobian: of the residual. weight: over the residual's variance.
  void Add(const Vector& jacobian, double residual, double weight) {
    hessian_.noalias() += weight * jacobian * jacobian.transpose();
    gradient_ += weight * residual * jacobian;
  }

  const Matrix& hessian() const { return hessian_; }
  const Vector& gradient() const { return gradient_; }
  // What is to be added to the parameters. The residuals and priors have to determine them.
  Vector Step() const { return hessian_.ldlt().solve(-gradient_); }

 private:
  Matrix hessian_ = Matrix::Zero();
  Vector gradient_ = Vector::Zero();
};

}  // namespace plumbline
