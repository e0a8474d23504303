#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "core/estimation/block_layout.h"

namespace plumbline {

// Normal equations of (part of) a problem at its current values: H = J^T J, g = J^T r, in the
// blocks' full tangent spaces (3 for a position, 3 for a rotation, or 1 when planar, and a
// landmark's parameters). Directions that are held have zero rows and columns.
struct NormalEquations {
  std::vector<BlockId> blocks;
  std::vector<int> offsets;  // first row of each block; the last element is the total size
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
  double cost = 0.0;  // where a problem has been linearised

  int size() const { return offsets.back(); }
};

inline int BlockSize(const NormalEquations& equations, size_t block) {
  return equations.offsets[block + 1] - equations.offsets[block];
}

// Position of a block in the equations; their number of blocks where it is not among them.
size_t FindBlock(const NormalEquations& equations, const BlockId& block);

// Rows of the blocks at these positions.
std::vector<int> RowsOf(const NormalEquations& equations, const std::vector<size_t>& blocks);

// Rows of the blocks for which keep(block) is true.
template <typename Keep>
std::vector<int> RowsOf(const NormalEquations& equations, Keep keep) {
  std::vector<int> rows;
  for (size_t i = 0; i < equations.blocks.size(); ++i) {
    if (!keep(equations.blocks[i])) continue;
    for (int row = equations.offsets[i]; row < equations.offsets[i + 1]; ++row) {
      rows.push_back(row);
    }
  }
  return rows;
}

// An empty system over these blocks, given with their sizes.
NormalEquations ZeroSystem(const std::map<BlockId, int>& sizes);

// system += part, whose blocks have these names in the system; several of them may share one.
void AddTo(const NormalEquations& part,
           const std::vector<BlockId>& names,
           NormalEquations* system);

}  // namespace plumbline
