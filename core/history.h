#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "core/estimation_problem.h"

namespace plumbline {

// What has been marginalised: a quadratic cost on some blocks about the values they had.
struct History {
  NormalEquations equations;
  std::vector<Eigen::VectorXd> at;  // parallel to equations.blocks

  History() { equations.offsets.assign(1, 0); }
};

inline bool IsLandmark(const BlockId& block) { return block.kind == BlockId::Kind::kLandmark; }

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
