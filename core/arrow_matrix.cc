#include "core/arrow_matrix.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"

namespace plumbline {

ArrowMatrix::ArrowMatrix(int num_band, int bandwidth, int num_border)
    : num_band_(num_band),
      band_(Eigen::MatrixXd::Zero(bandwidth + 1, num_band)),
      border_(Eigen::MatrixXd::Zero(num_band, num_border)),
      corner_(Eigen::MatrixXd::Zero(num_border, num_border)) {}

void ArrowMatrix::Add(int row, int column, double value) {
  DCHECK_GE(row, column);
  if (row < num_band_) {
    CHECK_LT(row - column, band_.rows()) << "outside the band";
    band_(row - column, column) += value;
  } else if (column < num_band_) {
    border_(column, row - num_band_) += value;
  } else {
    corner_(row - num_band_, column - num_band_) += value;
  }
}

void ArrowMatrix::AddBlock(const std::vector<int>& columns, const Eigen::MatrixXd& block) {
  for (size_t j = 0; j < columns.size(); ++j) {
    for (size_t i = j; i < columns.size(); ++i) {
      Add(columns[i],
          columns[j],
          block(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    }
  }
}

Eigen::MatrixXd ArrowMatrix::MarginaliseBand() {
  const Eigen::Index bandwidth = band_.rows() - 1;
  // Column by column: A = L L^T, and at the same time B <- L^-1 B.
  for (Eigen::Index j = 0; j < num_band_; ++j) {
    const double pivot = band_(0, j);
    if (!(pivot > 0.0))
      throw Error("the trajectory is not determined: singular normal matrix");
    const double root = std::sqrt(pivot);
    const Eigen::Index below = std::min<Eigen::Index>(bandwidth, num_band_ - 1 - j);
    band_(0, j) = root;
    band_.col(j).segment(1, below) /= root;
    border_.row(j) /= root;
    for (Eigen::Index k = 1; k <= below; ++k) {
      const double factor = band_(k, j);
      if (factor == 0.0) continue;
      band_.col(j + k).head(below - k + 1) -= factor * band_.col(j).segment(k, below - k + 1);
      border_.row(j + k) -= factor * border_.row(j);
    }
  }
  const Eigen::MatrixXd corner = corner_.selfadjointView<Eigen::Lower>();
  return corner - border_.transpose() * border_;
}

Eigen::MatrixXd ArrowInverse::BandBlock(Eigen::Index first, Eigen::Index size) const {
  CHECK_LE(size, band.rows());
  Eigen::MatrixXd block(size, size);
  for (Eigen::Index j = 0; j < size; ++j) {
    for (Eigen::Index i = j; i < size; ++i) {
      block(i, j) = block(j, i) = band(i - j, first + j);
    }
  }
  return block;
}

ArrowFactor::ArrowFactor(ArrowMatrix matrix) : matrix_(std::move(matrix)) {
  const Eigen::MatrixXd corner = matrix_.MarginaliseBand();
  // Scaled to a unit diagonal, so that metres and radians do not spoil the condition.
  corner_scale_ = corner.diagonal().cwiseSqrt().cwiseInverse();
  corner_.compute(corner_scale_.asDiagonal() * corner * corner_scale_.asDiagonal());
  if (corner_.info() != Eigen::Success) {
    throw Error("the planes are not determined: singular normal matrix");
  }
}

Eigen::VectorXd ArrowFactor::Solve(const Eigen::VectorXd& right_side) const {
  const Eigen::MatrixXd& band = matrix_.band_;
  const Eigen::MatrixXd& border = matrix_.border_;
  const Eigen::Index num_band = matrix_.num_band_;
  const auto below = [&](Eigen::Index j) {
    return std::min<Eigen::Index>(band.rows() - 1, num_band - 1 - j);
  };
  Eigen::VectorXd x = right_side.head(num_band);
  for (Eigen::Index j = 0; j < num_band; ++j) {
    x[j] /= band(0, j);
    x.segment(j + 1, below(j)) -= x[j] * band.col(j).segment(1, below(j));
  }
  const Eigen::VectorXd rest = right_side.tail(border.cols()) - border.transpose() * x;
  const Eigen::VectorXd y =
      corner_scale_.cwiseProduct(corner_.solve(corner_scale_.cwiseProduct(rest)));
  x -= border * y;
  for (Eigen::Index j = num_band - 1; j >= 0; --j) {
    x[j] =
        (x[j] - band.col(j).segment(1, below(j)).dot(x.segment(j + 1, below(j)))) / band(0, j);
  }
  Eigen::VectorXd solution(right_side.size());
  solution << x, y;
  return solution;
}

ArrowInverse ArrowFactor::Inverse() const {
  const Eigen::MatrixXd& band = matrix_.band_;
  const Eigen::MatrixXd border = matrix_.border_.transpose();  // columns are contiguous
  const Eigen::Index num_band = matrix_.num_band_;
  const Eigen::Index num_border = border.rows();
  ArrowInverse inverse;
  inverse.border = corner_scale_.asDiagonal() *
                   corner_.solve(Eigen::MatrixXd::Identity(num_border, num_border)) *
                   corner_scale_.asDiagonal();
  inverse.band.setZero(band.rows(), num_band);
  Eigen::MatrixXd cross(num_border, num_band);  // transposed while it grows
  // Z L = L^-T: entries of column j follow from those to its right.
  for (Eigen::Index j = num_band - 1; j >= 0; --j) {
    const Eigen::Index below = std::min(band.rows() - 1, num_band - 1 - j);
    const auto in_band = band.col(j).segment(1, below);
    const auto in_border = border.col(j);
    const double pivot = band(0, j);
    const auto right = cross.middleCols(j + 1, below);
    cross.col(j) = -(right * in_band + inverse.border * in_border) / pivot;
    const Eigen::VectorXd column =
        -(inverse.BandBlock(j + 1, below) * in_band + right.transpose() * in_border) / pivot;
    inverse.band.col(j).segment(1, below) = column;
    inverse.band(0, j) =
        (1.0 / pivot - column.dot(in_band) - cross.col(j).dot(in_border)) / pivot;
  }
  inverse.cross = cross.transpose();
  return inverse;
}

}  // namespace plumbline
