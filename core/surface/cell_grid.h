#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace plumbline {

// Returns the cell that a coordinate, in units of cells, lies in: its floor, without a
// library's call.
inline int CellIndex(double coordinate) {
  const int truncated = static_cast<int>(coordinate);
  return truncated - (coordinate < truncated ? 1 : 0);
}

// CellGrid holds counts on the cells of a plane's grid, in the rectangle that has been seen.
// Most of a map's grids are empty space: a cell takes two bytes, and its count stays at the
// largest that they hold.
class CellGrid {
 public:
  using Cell = std::pair<int, int>;
  static constexpr int kMaxCount = 65535;  // of uint16_t

  // Throws Error when the rectangle grows beyond any building's.
  void Add(const Cell& cell, int count) {
    if (count <= 0) return;
    if (!Covers(cell)) Cover(cell);
    uint16_t& at = counts_[Index(cell.first - first_.first, cell.second - first_.second)];
    if (at == 0) ++num_occupied_;
    at = static_cast<uint16_t>(std::min(at + std::min(count, kMaxCount), kMaxCount));
  }
  // Raises the count of a cell to this one where it is less.
  void Raise(const Cell& cell, int count) { Add(cell, count - Count(cell)); }
  int Count(const Cell& cell) const {
    return Covers(cell)
               ? counts_[Index(cell.first - first_.first, cell.second - first_.second)]
               : 0;
  }
  // True when a cell at most `reach` away in both directions has a count.
  bool IsNear(const Cell& cell, int reach) const;
  // Number of cells with a count.
  int num_occupied() const { return num_occupied_; }

  // Calls visit(cell, count) for the occupied cells, in order, until it returns true. Returns
  // whether it did.
  template <typename Visit>
  bool Any(Visit visit) const {
    for (int i = 0; i < size_.first; ++i) {
      for (int j = 0; j < size_.second; ++j) {
        const int count = counts_[Index(i, j)];
        if (count > 0 && visit(Cell(first_.first + i, first_.second + j), count)) return true;
      }
    }
    return false;
  }

  // Calls visit(member) for each: to keep them in a file and take them back.
  template <typename Visit>
  void VisitMembers(Visit& visit) {
    visit(first_.first);
    visit(first_.second);
    visit(size_.first);
    visit(size_.second);
    visit(counts_);
    visit(num_occupied_);
  }

 private:
  size_t Index(int i, int j) const {
    return static_cast<size_t>(i) * static_cast<size_t>(size_.second) + static_cast<size_t>(j);
  }
  bool Covers(const Cell& cell) const {
    const int i = cell.first - first_.first;
    const int j = cell.second - first_.second;
    return i >= 0 && i < size_.first && j >= 0 && j < size_.second;
  }
  void Cover(const Cell& cell);

  Cell first_ = {0, 0};
  Cell size_ = {0, 0};
  std::vector<uint16_t> counts_;  // row by row
  int num_occupied_ = 0;
};

}  // namespace plumbline
