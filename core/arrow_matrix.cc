#include "core/arrow_matrix.h"

#include <glog/logging.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace plumbline {

std::vector<int> PositionsOf(const std::vector<int>& variables,
                             const std::vector<int>& among) {
  std::vector<int> positions;
  positions.reserve(variables.size());
  auto at = among.begin();
  for (const int variable : variables) {
    at = std::lower_bound(at, among.end(), variable);
    CHECK(at != among.end() && *at == variable) << variable;
    positions.push_back(static_cast<int>(at - among.begin()));
  }
  return positions;
}

void ArrowTile::AddBorder(const std::vector<int>& variables, const Eigen::MatrixXd& block) {
  if (!std::includes(seen.begin(), seen.end(), variables.begin(), variables.end())) {
    std::vector<int> all;
    std::set_union(
        seen.begin(), seen.end(), variables.begin(), variables.end(), std::back_inserter(all));
    Eigen::MatrixXd larger =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(all.size()), diagonal.cols());
    larger(PositionsOf(seen, all), Eigen::all) = border;
    seen = std::move(all);
    border = std::move(larger);
  }
  border(PositionsOf(variables, seen), Eigen::all) += block;
}

ArrowMatrix::ArrowMatrix(int num_band, int tile_size, int num_border)
    : num_band_(num_band),
      tile_size_(tile_size),
      corner_(Eigen::MatrixXd::Zero(num_border, num_border)) {
  CHECK_GT(tile_size, 0);
  for (int first = 0; first < num_band; first += tile_size) {
    const int size = std::min(tile_size, num_band - first);
    ArrowTile tile;
    tile.first = first;
    tile.diagonal.setZero(size, size);
    tile.next.setZero(std::clamp(num_band - first - size, 0, tile_size), size);
    tile.border.resize(0, size);
    tiles_.push_back(std::move(tile));
  }
}

void ArrowMatrix::AddBlock(const std::vector<int>& columns, const Eigen::MatrixXd& block) {
  const auto band_end = std::lower_bound(columns.begin(), columns.end(), num_band_);
  std::vector<int> border;
  for (auto at = band_end; at != columns.end(); ++at) border.push_back(*at - num_band_);
  const auto num_in_band = static_cast<Eigen::Index>(band_end - columns.begin());
  const auto num_in_border = static_cast<Eigen::Index>(border.size());
  corner_(border, border) += block.bottomRightCorner(num_in_border, num_in_border);
  for (Eigen::Index begin = 0; begin < num_in_band;) {
    const int index = columns[static_cast<size_t>(begin)] / tile_size_;
    ArrowTile& tile = tiles_[static_cast<size_t>(index)];
    Eigen::Index end = begin;
    while (end < num_in_band && columns[static_cast<size_t>(end)] / tile_size_ == index) ++end;
    Eigen::MatrixXd border_block = Eigen::MatrixXd::Zero(num_in_border, tile.size());
    for (Eigen::Index j = begin; j < end; ++j) {
      const int column = columns[static_cast<size_t>(j)] - tile.first;
      for (Eigen::Index i = j; i < num_in_band; ++i) {
        const int row = columns[static_cast<size_t>(i)] - tile.first;
        CHECK_LT(row, 2 * tile_size_) << "outside the band";
        if (row < tile_size_) {
          tile.diagonal(row, column) += block(i, j);
        } else {
          tile.next(row - tile_size_, column) += block(i, j);
        }
      }
      border_block.col(column) = block.col(j).tail(num_in_border);
    }
    if (num_in_border > 0) tile.AddBorder(border, border_block);
    begin = end;
  }
}

}  // namespace plumbline
