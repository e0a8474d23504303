#include "factors/linear_algebra/square_root_marginalisation.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

// Cholesky's elimination of a positive semi-definite matrix with a gradient, the largest
// remaining pivot first. Scaled to a unit diagonal: metres and radians become comparable, and
// rounding errors are then of the size of epsilon itself.
class PivotedElimination {
 public:
  PivotedElimination(const Eigen::MatrixXd& lower, const Eigen::VectorXd& gradient)
      : scale_(lower.diagonal().unaryExpr(
            [](double value) { return value > 0.0 ? 1.0 / std::sqrt(value) : 1.0; })),
        matrix_(lower),
        gradient_(scale_.cwiseProduct(gradient)),
        order_(static_cast<size_t>(lower.rows())) {
    matrix_ = scale_.asDiagonal() * matrix_ * scale_.asDiagonal();
    std::iota(order_.begin(), order_.end(), 0);
  }

  // Eliminates variables from among those at positions begin .. end - 1, as long as more than
  // the tolerance remains of one; returns how many. Visits each: (row of the root over the
  // variables, scaling undone; its offset).
  template <typename Visit>
  int Eliminate(Eigen::Index begin, Eigen::Index end, double tolerance, Visit visit) {
    const Eigen::Index size = matrix_.rows();
    const double indefinite = -100.0 * std::max(tolerance, 1e-13 * static_cast<double>(size));
    Eigen::RowVectorXd row(size);
    for (Eigen::Index k = begin; k < end; ++k) {
      Eigen::Index pivot_at = 0;
      const double pivot = matrix_.diagonal().segment(k, end - k).maxCoeff(&pivot_at);
      if (!std::isfinite(pivot)) {
        throw std::runtime_error("the normal matrix has entries that are not finite");
      }
      if (matrix_.diagonal().segment(k, end - k).minCoeff() < indefinite) {
        throw std::runtime_error("the normal matrix is not positive semi-definite");
      }
      if (!(pivot > tolerance)) return static_cast<int>(k - begin);
      Swap(k, k + pivot_at);
      const double root = std::sqrt(pivot);
      const Eigen::Index after = size - k - 1;
      const double offset = gradient_[k] / root;
      const Eigen::VectorXd column = matrix_.col(k).tail(after) / root;
      gradient_.tail(after) -= offset * column;
      for (Eigen::Index j = 0; j < after; ++j) {
        matrix_.col(k + 1 + j).tail(after - j) -= column[j] * column.tail(after - j);
      }
      row.setZero();
      row[order_[static_cast<size_t>(k)]] = root;
      for (Eigen::Index j = 0; j < after; ++j) {
        row[order_[static_cast<size_t>(k + 1 + j)]] = column[j];
      }
      visit(row.cwiseQuotient(scale_.transpose()), offset);
    }
    return static_cast<int>(end - begin);
  }

  // The variables as they have been eliminated, then the others.
  const std::vector<int>& order() const { return order_; }

 private:
  // In the lower triangle of what is not eliminated yet; b >= a.
  void Swap(Eigen::Index a, Eigen::Index b) {
    if (a == b) return;
    const Eigen::Index between = b - a - 1;
    const Eigen::Index below = matrix_.rows() - b - 1;
    std::swap(matrix_(a, a), matrix_(b, b));
    matrix_.col(a)
        .segment(a + 1, between)
        .swap(matrix_.row(b).segment(a + 1, between).transpose());
    matrix_.col(a).tail(below).swap(matrix_.col(b).tail(below));
    std::swap(gradient_[a], gradient_[b]);
    std::swap(order_[static_cast<size_t>(a)], order_[static_cast<size_t>(b)]);
  }

  Eigen::VectorXd scale_;
  Eigen::MatrixXd matrix_;  // lower triangle
  Eigen::VectorXd gradient_;
  std::vector<int> order_;
};

}  // namespace

MarginalisedSystem Marginalise(const Eigen::MatrixXd& hessian,
                               const Eigen::VectorXd& gradient,
                               int num_marginalised,
                               double relative_tolerance) {
  const Eigen::Index size = hessian.rows();
  const Eigen::Index num_kept = size - num_marginalised;
  CHECK_EQ(hessian.rows(), hessian.cols());
  CHECK_EQ(hessian.rows(), gradient.size());
  CHECK_GE(num_marginalised, 0);
  CHECK_GE(num_kept, 1);

  PivotedElimination elimination(hessian, gradient);
  MarginalisedSystem system;
  system.marginalised_rank = elimination.Eliminate(
      0, num_marginalised, relative_tolerance, [](const Eigen::RowVectorXd&, double) {});
  Eigen::MatrixXd root(num_kept, num_kept);
  Eigen::VectorXd offset(num_kept);
  Eigen::Index next = 0;
  system.rank = elimination.Eliminate(num_marginalised,
                                      size,
                                      relative_tolerance,
                                      [&](const Eigen::RowVectorXd& row, double row_offset) {
                                        root.row(next) = row.tail(num_kept);
                                        offset[next] = row_offset;
                                        ++next;
                                      });
  for (Eigen::Index k = num_marginalised; k < size; ++k) {
    system.order.push_back(elimination.order()[static_cast<size_t>(k)] - num_marginalised);
  }
  system.root = root.topRows(system.rank);
  system.offset = offset.head(system.rank);
  return system;
}

}  // namespace plumbline
