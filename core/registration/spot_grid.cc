#include "core/registration/spot_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace plumbline {

SpotGrid::SpotGrid(std::vector<WallSpot> spots, double cell_m)
    : cell_m_(cell_m), spots_(std::move(spots)) {
  std::stable_sort(spots_.begin(), spots_.end(), [this](const WallSpot& a, const WallSpot& b) {
    return KeyOf(a.position, 0, 0) < KeyOf(b.position, 0, 0);
  });
  for (size_t i = 0; i < spots_.size(); ++i) {
    const uint64_t key = KeyOf(spots_[i].position, 0, 0);
    if (cells_.empty() || cells_.back().key != key) cells_.push_back({key, i, i});
    cells_.back().end = i + 1;
  }
}

uint64_t SpotGrid::KeyOf(const Eigen::Vector2d& p, int right, int up) const {
  constexpr int64_t kOffset = int64_t{1} << 30;
  const auto cell = [&](double value) {
    return static_cast<int64_t>(std::floor(value / cell_m_)) + kOffset;
  };
  return (static_cast<uint64_t>(cell(p.x()) + right) << 32) |
         static_cast<uint64_t>(cell(p.y()) + up);
}

const SpotGrid::Cell* SpotGrid::FindCell(uint64_t key) const {
  const auto cell =
      std::lower_bound(cells_.begin(), cells_.end(), key, [](const Cell& one, uint64_t of) {
        return one.key < of;
      });
  return cell != cells_.end() && cell->key == key ? &*cell : nullptr;
}

}  // namespace plumbline
