#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace plumbline {

// A spot of a wall as seen from above.
struct WallSpot {
  Eigen::Vector2d position;  // m
  Eigen::Vector2d normal;    // unit vector, or zero where none is known
};

// SpotGrid finds spots of walls near a place.
class SpotGrid {
 public:
  // Keeps the spots by cell, in the order given within one.
  SpotGrid(std::vector<WallSpot> spots, double cell_m);

  const std::vector<WallSpot>& spots() const { return spots_; }

  // Calls visit(spot) for those in the cell of a point and those around it: all within a
  // cell's side, and some beyond.
  template <typename Visit>
  void ForEachNear(const Eigen::Vector2d& p, const Visit& visit) const {
    for (int up = -1; up <= 1; ++up) {
      for (int right = -1; right <= 1; ++right) {
        const Cell* cell = FindCell(KeyOf(p, right, up));
        if (cell == nullptr) continue;
        for (size_t i = cell->begin; i < cell->end; ++i) visit(spots_[i]);
      }
    }
  }

 private:
  struct Cell {
    uint64_t key = 0;
    size_t begin = 0;  // its spots
    size_t end = 0;
  };

  // Of the cell that lies this many to the right of and above a point's.
  uint64_t KeyOf(const Eigen::Vector2d& p, int right, int up) const;
  const Cell* FindCell(uint64_t key) const;

  double cell_m_;
  std::vector<WallSpot> spots_;  // by cell
  std::vector<Cell> cells_;      // by key, ascending
};

}  // namespace plumbline
