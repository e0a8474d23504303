#pragma once

#include <Eigen/Core>
#include <unordered_map>
#include <vector>

#include "core/estimation/arrowhead_cholesky.h"

namespace plumbline {

// BorderSolver solves H x = b for many sparse right sides, of which the border's part of x is
// asked for. The right sides come in pieces; pieces that lie close together in the band are
// eliminated together, with the right sides that they belong to and no others. No column of x
// is ever held in the band, so that time and memory grow with the pieces, not with the band's
// length times the number of right sides.
class BorderSolver {
 public:
  // factor has to outlive the solver.
  explicit BorderSolver(const ArrowheadCholesky& factor);

  // b(row .. row + rows - 1, columns[j]) += loads.col(j), in the band. Fast where the calls
  // follow the band; columns may repeat, and are best numbered without gaps.
  void AddToBand(int row,
                 const Eigen::Ref<const Eigen::MatrixXd>& loads,
                 const std::vector<int>& columns);
  // Adds loads to b in the border, row 0 being the border's first.
  void AddToBorder(int row,
                   const Eigen::Ref<const Eigen::MatrixXd>& loads,
                   const std::vector<int>& columns);

  // The border's rows of x, by the columns added so far. To be called once.
  Eigen::MatrixXd TakeSolution();

 private:
  using Level = ArrowheadCholesky::Level;
  // Right sides within the tiles of a subdomain, of those columns that are not zero there.
  struct Piece {
    size_t subdomain = 0;
    std::vector<int> columns;
    std::unordered_map<int, int> positions;  // of the columns
    Eigen::MatrixXd rows;                    // with room for more columns
  };

  Piece& PieceOf(size_t level, size_t subdomain);
  // Adds to rows at .. of a level's tile; the block's columns are those of the right sides.
  void AddToTile(size_t level,
                 size_t tile,
                 int at,
                 const Eigen::Ref<const Eigen::MatrixXd>& block,
                 const std::vector<int>& columns);
  // Eliminates a piece; what it leaves goes to the next level and to the border.
  void Eliminate(size_t level, Piece piece);
  Eigen::Ref<Eigen::VectorXd> BorderColumn(int column);

  const ArrowheadCholesky& factor_;
  const Eigen::Index num_border_;
  std::vector<std::vector<Piece>> open_;  // by level, the last used last
  Eigen::MatrixXd border_;                // with room for more columns
  Eigen::Index num_columns_ = 0;
};

}  // namespace plumbline
