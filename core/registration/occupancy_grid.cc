#include "core/registration/occupancy_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/cell_key.h"

namespace plumbline {
namespace {

// Counts are halved when one reaches this: what is seen now weighs more than what was.
constexpr uint16_t kMaxCount = 4096;
// A cell is empty if at least kMinPasses beams have passed, and fewer than one for
// kMaxEndShare of these ended in it. Beams along a wall pass through its cells too: one in ten
// ends there.
constexpr int kMinPasses = 4;
constexpr int kMaxEndShare = 20;

}  // namespace

OccupancyGrid::Index OccupancyGrid::IndexOf(const Eigen::Vector3d& p_world) const {
  return (p_world / cell_m_).array().floor().cast<int>();
}

uint64_t OccupancyGrid::KeyOf(const Index& cell) {
  return CellKey({cell[0] >> kBlockBits, cell[1] >> kBlockBits, cell[2] >> kBlockBits});
}

size_t OccupancyGrid::InBlock(const Index& cell) {
  size_t at = 0;
  for (int axis = 0; axis < 3; ++axis) {
    at = (at << kBlockBits) | static_cast<size_t>(cell[axis] & (kBlockSide - 1));
  }
  return at;
}

OccupancyGrid::Block* OccupancyGrid::BlockOf(const Index& cell) {
  const uint64_t key = KeyOf(cell);
  if (Block* block = last_.Get(key)) return block;
  const auto it = blocks_.find(key);
  if (it == blocks_.end()) return nullptr;
  last_.Set(key, &it->second);
  return &it->second;
}

const OccupancyGrid::Cell* OccupancyGrid::Find(const Index& cell) {
  const Block* block = BlockOf(cell);
  return block == nullptr ? nullptr : &block->cells[InBlock(cell)];
}

void OccupancyGrid::AddBeam(const Eigen::Vector3d& from_world,
                            const Eigen::Vector3d& to_world,
                            bool ends,
                            int scan_index) {
  const auto cell_at = [&](const Index& index) -> Cell& {
    Block* block = BlockOf(index);
    if (block == nullptr) block = &blocks_[KeyOf(index)];
    block->last_scan = scan_index;
    Cell& cell = block->cells[InBlock(index)];
    if (cell.passes >= kMaxCount || cell.ends >= kMaxCount) {
      cell.passes /= 2;
      cell.ends /= 2;
    }
    return cell;
  };
  // From cell to cell (Amanatides and Woo 1987).
  Index index = IndexOf(from_world);
  const Index last = IndexOf(to_world);
  const Eigen::Vector3d along = to_world - from_world;
  Eigen::Vector3d next;   // share of the beam at the next border, by axis
  Eigen::Vector3d width;  // share of the beam from border to border
  Index step;
  for (int axis = 0; axis < 3; ++axis) {
    step[axis] = along[axis] > 0.0 ? 1 : -1;
    const double border = (index[axis] + (step[axis] > 0 ? 1 : 0)) * cell_m_;
    const bool runs = std::abs(along[axis]) > 1e-12;
    next[axis] = runs ? (border - from_world[axis]) / along[axis]
                      : std::numeric_limits<double>::infinity();
    width[axis] =
        runs ? cell_m_ / std::abs(along[axis]) : std::numeric_limits<double>::infinity();
  }
  const int num_steps = (last - index).cwiseAbs().sum();
  for (int i = 0; i < num_steps; ++i) {
    ++cell_at(index).passes;
    int axis = 0;
    next.minCoeff(&axis);
    index[axis] += step[axis];
    next[axis] += width[axis];
  }
  if (ends) ++cell_at(last).ends;
}

bool OccupancyGrid::IsEmpty(const Eigen::Vector3d& p_world, double margin_m) {
  const auto is_empty = [](const Cell* cell) {
    return cell != nullptr && cell->passes >= kMinPasses &&
           cell->ends * kMaxEndShare < cell->passes;
  };
  if (!is_empty(Find(IndexOf(p_world)))) return false;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d to_corner((corner & 1) != 0 ? margin_m : -margin_m,
                                    (corner & 2) != 0 ? margin_m : -margin_m,
                                    (corner & 4) != 0 ? margin_m : -margin_m);
    const Cell* cell = Find(IndexOf(p_world + to_corner));
    if (cell != nullptr && cell->ends * kMaxEndShare > cell->passes) return false;
  }
  return true;
}

void OccupancyGrid::ForgetBefore(int scan_index) {
  last_.Forget();
  for (auto it = blocks_.begin(); it != blocks_.end();) {
    it = it->second.last_scan < scan_index ? blocks_.erase(it) : std::next(it);
  }
}

}  // namespace plumbline
