#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

namespace plumbline {

// A symmetric positive definite matrix of the batch's shape (paper, Figure 2): a band, from
// the spline's control points in the order of time, and a full border, from the planes.
//
//   H = [ A   B ]   A: num_band x num_band, non-zero only within `bandwidth` of the diagonal
//       [ B^T C ]   C: num_border x num_border
class ArrowMatrix {
 public:
  ArrowMatrix(int num_band, int bandwidth, int num_border);

  // H(row, column) += value for row >= column. CHECKs that it lies in the band or border.
  void Add(int row, int column, double value);
  // H(columns, columns) += the symmetric block; columns ascending.
  void AddBlock(const std::vector<int>& columns, const Eigen::MatrixXd& block);

  int size() const { return num_band_ + static_cast<int>(corner_.rows()); }

  // C - B^T A^-1 B: the information on the border when the band is marginalised. Overwrites
  // the band with its Cholesky factor. Throws Error when A is not positive definite.
  Eigen::MatrixXd MarginaliseBand();

 private:
  int num_band_;
  Eigen::MatrixXd band_;    // (bandwidth + 1) x num_band: band_(i, j) = A(j + i, j)
  Eigen::MatrixXd border_;  // num_band x num_border: B
  Eigen::MatrixXd corner_;  // lower triangle of C

  friend class ArrowFactor;
};

// The entries of the inverse that lie where the matrix has its own.
struct ArrowInverse {
  Eigen::MatrixXd band;    // (bandwidth + 1) x num_band: band(i, j) = entry (j + i, j)
  Eigen::MatrixXd cross;   // num_band x num_border
  Eigen::MatrixXd border;  // num_border x num_border

  // Rows and columns first .. first + size - 1 of the band; size at most bandwidth + 1.
  Eigen::MatrixXd BandBlock(Eigen::Index first, Eigen::Index size) const;
};

// Cholesky factor of an arrow matrix.
class ArrowFactor {
 public:
  // Throws Error when the matrix is not positive definite.
  explicit ArrowFactor(ArrowMatrix matrix);

  Eigen::VectorXd Solve(const Eigen::VectorXd& right_side) const;

  // The inverse's entries by Takahashi's recursion, from the last column to the first:
  // (bandwidth + num_border)^2 operations a column, whatever the size.
  ArrowInverse Inverse() const;

 private:
  ArrowMatrix matrix_;  // its band holds L, its border L^-1 B
  Eigen::LLT<Eigen::MatrixXd> corner_;
  Eigen::VectorXd corner_scale_;  // the factor is that of S C' S, S = diag(scale)
};

}  // namespace plumbline
