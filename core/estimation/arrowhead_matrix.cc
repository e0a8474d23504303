#include "core/estimation/arrowhead_matrix.h"

#include <glog/logging.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace plumbline {
namespace {

void AddEntry(int row, double value, std::vector<std::pair<int, double>>* column) {
  const auto at = std::lower_bound(
      column->begin(), column->end(), row, [](const std::pair<int, double>& entry, int of) {
        return entry.first < of;
      });
  if (at != column->end() && at->first == row) {
    at->second += value;
  } else {
    column->emplace(at, row, value);
  }
}

}  // namespace

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

std::vector<int> ArrowheadTile::BorderRows(const std::vector<int>& variables) {
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
  return PositionsOf(variables, seen);
}

ArrowheadMatrix::ArrowheadMatrix(int num_band, int tile_size, int num_border)
    : num_band_(num_band), tile_size_(tile_size), corner_(static_cast<size_t>(num_border)) {
  CHECK_GT(tile_size, 0);
  for (int first = 0; first < num_band; first += tile_size) {
    const int size = std::min(tile_size, num_band - first);
    ArrowheadTile tile;
    tile.first = first;
    tile.diagonal.setZero(size, size);
    tile.next.setZero(std::clamp(num_band - first - size, 0, tile_size), size);
    tile.border.resize(0, size);
    tiles_.push_back(std::move(tile));
  }
}

void ArrowheadMatrix::AddBlock(const std::vector<int>& columns, const Eigen::MatrixXd& block) {
  const auto band_end = std::lower_bound(columns.begin(), columns.end(), num_band_);
  std::vector<int> border;
  for (auto at = band_end; at != columns.end(); ++at) border.push_back(*at - num_band_);
  const auto num_in_band = static_cast<Eigen::Index>(band_end - columns.begin());
  const auto num_in_border = static_cast<Eigen::Index>(border.size());
  for (Eigen::Index j = 0; j < num_in_border; ++j) {
    auto& column = corner_[static_cast<size_t>(border[static_cast<size_t>(j)])];
    for (Eigen::Index i = 0; i < num_in_border; ++i) {
      const double value = block(num_in_band + i, num_in_band + j);
      if (value != 0.0) AddEntry(border[static_cast<size_t>(i)], value, &column);
    }
  }
  for (Eigen::Index begin = 0; begin < num_in_band;) {
    const int index = columns[static_cast<size_t>(begin)] / tile_size_;
    ArrowheadTile& tile = tiles_[static_cast<size_t>(index)];
    const int next_first = tile.first + tile_size_;
    CHECK_LT(*(band_end - 1), next_first + tile_size_) << "outside the band";
    const auto end = static_cast<Eigen::Index>(
        std::lower_bound(columns.begin() + begin, band_end, next_first) - columns.begin());
    std::vector<int> border_rows;
    if (num_in_border > 0) border_rows = tile.BorderRows(border);
    for (Eigen::Index j = begin; j < end; ++j) {
      const int column = columns[static_cast<size_t>(j)] - tile.first;
      double* const diagonal = tile.diagonal.col(column).data();
      for (Eigen::Index i = j; i < end; ++i) {
        diagonal[columns[static_cast<size_t>(i)] - tile.first] += block(i, j);
      }
      double* const next = tile.next.col(column).data();
      for (Eigen::Index i = end; i < num_in_band; ++i) {
        next[columns[static_cast<size_t>(i)] - next_first] += block(i, j);
      }
      double* const below = tile.border.col(column).data();
      for (Eigen::Index i = 0; i < num_in_border; ++i) {
        below[border_rows[static_cast<size_t>(i)]] += block(num_in_band + i, j);
      }
    }
    begin = end;
  }
}

ArrowheadMatrix ArrowheadMatrix::Band() const {
  ArrowheadMatrix band(num_band_, tile_size_, 0);
  for (size_t i = 0; i < tiles_.size(); ++i) {
    band.tiles_[i].diagonal = tiles_[i].diagonal;
    band.tiles_[i].next = tiles_[i].next;
  }
  return band;
}

}  // namespace plumbline
