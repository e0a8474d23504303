#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace plumbline {

// ArrowheadTile holds consecutive variables of the band, with their share of the matrix.
struct ArrowheadTile {
  int first = 0;             // row of its first variable
  Eigen::MatrixXd diagonal;  // the tile's own block; of a symmetric matrix the lower triangle
  Eigen::MatrixXd next;      // rows of the tile that follows, columns of this one
  // Border variables that have entries here, ascending: others have none.
  std::vector<int> seen;
  Eigen::MatrixXd border;  // their rows, this tile's columns

  int size() const { return static_cast<int>(diagonal.cols()); }
  // The border's rows of these variables, which are made if there are none yet; `variables`
  // ascending.
  std::vector<int> BorderRows(const std::vector<int>& variables);
  // border(rows of these variables) += block
  void AddBorder(const std::vector<int>& variables, const Eigen::MatrixXd& block) {
    border(BorderRows(variables), Eigen::all) += block;
  }
};

// Returns the positions of `variables` in `among`; both ascending. CHECKs that they are there.
std::vector<int> PositionsOf(const std::vector<int>& variables, const std::vector<int>& among);

// ArrowheadMatrix is a symmetric positive definite matrix of the batch's shape (paper, Figure
// 2): a band, from the spline's control points in the order of time, and a border, from the
// planes.
//
//   H = [ A   B ]   A: num_band x num_band, non-zero only within and between adjacent tiles
//       [ B^T C ]   C: num_border x num_border
//
// B and C hold only what has been added: a tile sees few of the planes, and planes have little
// to do with each other but for the poses from which they were seen.
class ArrowheadMatrix {
 public:
  // Makes tiles of tile_size variables, the last one smaller where num_band is no multiple.
  ArrowheadMatrix(int num_band, int tile_size, int num_border);

  // H(columns, columns) += the symmetric block; columns ascending, those of the band in the
  // same tile or in adjacent ones, which is CHECKed.
  void AddBlock(const std::vector<int>& columns, const Eigen::MatrixXd& block);

  // A, without a border.
  ArrowheadMatrix Band() const;

  int size() const { return num_band_ + static_cast<int>(corner_.size()); }

 private:
  int num_band_;
  int tile_size_;
  std::vector<ArrowheadTile> tiles_;
  // Entries of C by column, both triangles: row and value, rows ascending.
  std::vector<std::vector<std::pair<int, double>>> corner_;

  friend class ArrowheadCholesky;
};

}  // namespace plumbline
