#include "core/arrow_matrix.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

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

}  // namespace plumbline
