#include "factors/linear_algebra/symmetric_inverse.h"

#include <glog/logging.h>

#include <utility>

namespace plumbline {
namespace {

// column -= a x + b y. A plain loop: Eigen's columns of some dozens of rows, of any number and
// alignment, take twice the time.
void Subtract(Eigen::Index size,
              double a,
              const double* x,
              double b,
              const double* y,
              double* __restrict column) {
  for (Eigen::Index i = 0; i < size; ++i) column[i] -= a * x[i] + b * y[i];
}

// A symmetric matrix, kept in its lower triangle, whose variables are swept one after the
// other: sweeping a_kk exchanges the roles of variable k and its equation.
class SweptMatrix {
 public:
  explicit SweptMatrix(Eigen::MatrixXd lower)
      : matrix_(std::move(lower)), first_(matrix_.rows()), second_(matrix_.rows()) {}

  // Sweeps the variables k and k + 1 in one pass over the matrix; false where it is not
  // positive definite.
  bool SweepTwo(Eigen::Index k) {
    const Eigen::Index size = matrix_.rows();
    const double pivot = matrix_(k, k);
    const double coupling = matrix_(k + 1, k) / pivot;
    const double next_pivot = matrix_(k + 1, k + 1) - coupling * matrix_(k + 1, k);
    if (!(pivot > 0.0) || !(next_pivot > 0.0)) return false;
    TakeColumn(k, &first_);
    TakeColumn(k + 1, &second_);
    second_ -= coupling * first_;
    first_.segment<2>(k).setZero();
    second_.segment<2>(k).setZero();
    const double by_first = 1.0 / pivot;
    const double by_second = 1.0 / next_pivot;
    for (Eigen::Index j = 0; j < size; ++j) {
      Subtract(size - j,
               by_first * first_[j],
               first_.data() + j,
               by_second * second_[j],
               second_.data() + j,
               &matrix_(j, j));
    }
    second_ *= by_second;
    first_ = by_first * first_ - coupling * second_;
    PutColumn(k, first_);
    PutColumn(k + 1, second_);
    matrix_(k, k) = -by_first - coupling * coupling * by_second;
    matrix_(k + 1, k) = coupling * by_second;
    matrix_(k + 1, k + 1) = -by_second;
    return true;
  }

  const Eigen::MatrixXd& lower() const { return matrix_; }

 private:
  void TakeColumn(Eigen::Index k, Eigen::VectorXd* column) const {
    const Eigen::Index rest = matrix_.rows() - k;
    column->head(k) = matrix_.row(k).head(k).transpose();
    column->tail(rest) = matrix_.col(k).tail(rest);
  }
  void PutColumn(Eigen::Index k, const Eigen::VectorXd& column) {
    const Eigen::Index rest = matrix_.rows() - k;
    matrix_.row(k).head(k) = column.head(k).transpose();
    matrix_.col(k).tail(rest) = column.tail(rest);
  }

  Eigen::MatrixXd matrix_;
  Eigen::VectorXd first_;
  Eigen::VectorXd second_;
};

// Scaled to a unit diagonal, so that metres and radians do not spoil the condition, and with a
// variable more where their number is odd.
Eigen::MatrixXd ScaledPairs(const Eigen::MatrixXd& lower, const Eigen::VectorXd& scale) {
  const Eigen::Index size = lower.rows();
  Eigen::MatrixXd scaled(size + size % 2, size + size % 2);
  scaled.topLeftCorner(size, size) = scale.asDiagonal() * lower * scale.asDiagonal();
  if (size % 2 == 1) scaled.row(size) = Eigen::RowVectorXd::Unit(size + 1, size);
  return scaled;
}

}  // namespace

// With all variables swept, the matrix is the negative of its inverse.
std::optional<Eigen::MatrixXd> SymmetricInverse(const Eigen::MatrixXd& lower) {
  CHECK_EQ(lower.rows(), lower.cols());
  const Eigen::Index size = lower.rows();
  if (!(lower.diagonal().array() > 0.0).all()) return std::nullopt;
  const Eigen::VectorXd scale = lower.diagonal().cwiseSqrt().cwiseInverse();
  SweptMatrix swept(ScaledPairs(lower, scale));
  for (Eigen::Index k = 0; k < size; k += 2) {
    if (!swept.SweepTwo(k)) return std::nullopt;
  }
  Eigen::MatrixXd inverse =
      -(scale.asDiagonal() * swept.lower().topLeftCorner(size, size) * scale.asDiagonal());
  inverse.triangularView<Eigen::StrictlyUpper>() = inverse.transpose();
  return inverse;
}

}  // namespace plumbline
