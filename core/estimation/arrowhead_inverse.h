#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "core/estimation/arrowhead_matrix.h"

namespace plumbline {

// ArrowheadInverse holds the entries of the inverse within and between adjacent tiles, and its
// border.
class ArrowheadInverse {
 public:
  ArrowheadInverse() = default;
  ArrowheadInverse(int tile_size, std::vector<ArrowheadTile> tiles, Eigen::MatrixXd border)
      : tile_size_(tile_size), tiles_(std::move(tiles)), border_(std::move(border)) {}

  // Rows and columns first .. first + size - 1 of the band, within two adjacent tiles.
  Eigen::MatrixXd BandBlock(int first, int size) const;
  const Eigen::MatrixXd& border() const { return border_; }

  // Sets this variable's row and column to zero; only for one that no other depends on.
  void Clear(int variable);

 private:
  int tile_size_ = 1;
  std::vector<ArrowheadTile> tiles_;  // diagonal in full
  Eigen::MatrixXd border_;
};

}  // namespace plumbline
