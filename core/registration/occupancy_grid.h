#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <unordered_map>

#include "core/util/last_found.h"

namespace plumbline {

// OccupancyGrid counts, in cubes of space around the rig, the beams that ended there and those
// that passed. A point where beams have passed again and again and hardly any ended belongs to
// something that moves: people, doors.
class OccupancyGrid {
 public:
  explicit OccupancyGrid(double cell_m) : cell_m_(cell_m) {}

  // Counts a beam (world frame, m). ends: whether what it ended on counts, or only where it
  // passed.
  void AddBeam(const Eigen::Vector3d& from_world,
               const Eigen::Vector3d& to_world,
               bool ends,
               int scan_index);
  // Whether the place of a point was seen to be empty, and so was what lies within the margin
  // around it.
  bool IsEmpty(const Eigen::Vector3d& p_world, double margin_m);
  // Forgets what was not seen since this scan.
  void ForgetBefore(int scan_index);

 private:
  static constexpr int kBlockBits = 3;
  static constexpr int kBlockSide = 1 << kBlockBits;  // cells

  struct Cell {
    uint16_t ends = 0;
    uint16_t passes = 0;
  };
  // Cells come in blocks, so that a beam looks up a block once in several steps.
  struct Block {
    std::array<Cell, kBlockSide * kBlockSide * kBlockSide> cells;
    int last_scan = 0;
  };
  using Index = Eigen::Matrix<int, 3, 1>;

  Index IndexOf(const Eigen::Vector3d& p_world) const;
  static uint64_t KeyOf(const Index& cell);
  static size_t InBlock(const Index& cell);
  // The block of a cell, or nullptr.
  Block* BlockOf(const Index& cell);
  const Cell* Find(const Index& cell);

  double cell_m_;
  std::unordered_map<uint64_t, Block> blocks_;
  // The block that was asked for last: most often it is the next one as well.
  LastFound<uint64_t, Block> last_;
};

}  // namespace plumbline
