#include "core/surface/cell_grid.h"

#include <algorithm>

#include "core/util/error.h"

namespace plumbline {
namespace {

constexpr double kMaxCells = 1e8;  // 2.5 km squared at 0.25 m

// The range first .. first + size - 1 enlarged to hold `value`, with room for more beyond it.
std::pair<int, int> Enlarged(int first, int size, int value) {
  const int room = std::max(4, size / 2);
  const int low = value < first ? value - room : first;
  const int high = value >= first + size ? value + room : first + size - 1;
  return {low, high - low + 1};
}

}  // namespace

void CellGrid::Cover(const Cell& cell) {
  if (size_.first == 0) {
    first_ = cell;
    size_ = {1, 1};
    counts_.assign(1, 0);
    return;
  }
  const auto [first_i, size_i] = Enlarged(first_.first, size_.first, cell.first);
  const auto [first_j, size_j] = Enlarged(first_.second, size_.second, cell.second);
  if (Cell(size_i, size_j) == size_) return;
  if (static_cast<double>(size_i) * size_j > kMaxCells) {
    throw Error("a plane's patch has grown beyond any building: the estimate has gone astray");
  }
  CellGrid larger;
  larger.first_ = {first_i, first_j};
  larger.size_ = {size_i, size_j};
  larger.counts_.assign(static_cast<size_t>(size_i) * static_cast<size_t>(size_j), 0);
  Any([&](const Cell& occupied, int count) {
    const int i = occupied.first - larger.first_.first;
    const int j = occupied.second - larger.first_.second;
    larger.counts_[larger.Index(i, j)] = static_cast<uint16_t>(count);
    return false;
  });
  larger.num_occupied_ = num_occupied_;
  *this = std::move(larger);
}

bool CellGrid::IsNear(const Cell& cell, int reach) const {
  const int first_i = std::max(cell.first - reach - first_.first, 0);
  const int last_i = std::min(cell.first + reach - first_.first, size_.first - 1);
  const int first_j = std::max(cell.second - reach - first_.second, 0);
  const int last_j = std::min(cell.second + reach - first_.second, size_.second - 1);
  for (int i = first_i; i <= last_i; ++i) {
    for (int j = first_j; j <= last_j; ++j) {
      if (counts_[Index(i, j)] > 0) return true;
    }
  }
  return false;
}

}  // namespace plumbline
