#pragma once

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

  // C - B^T A^-1 B: the information on the border when the band is marginalised. Overwrites
  // the band with its Cholesky factor. Throws Error when A is not positive definite.
  Eigen::MatrixXd MarginaliseBand();

 private:
  int num_band_;
  Eigen::MatrixXd band_;    // (bandwidth + 1) x num_band: band_(i, j) = A(j + i, j)
  Eigen::MatrixXd border_;  // num_band x num_border: B
  Eigen::MatrixXd corner_;  // lower triangle of C
};

}  // namespace plumbline
