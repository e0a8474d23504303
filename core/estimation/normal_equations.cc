#include "core/estimation/normal_equations.h"

#include <glog/logging.h>

#include <algorithm>

#include "core/estimation/block_layout.h"

namespace plumbline {

size_t FindBlock(const NormalEquations& equations, const BlockId& block) {
  const auto at = std::lower_bound(equations.blocks.begin(), equations.blocks.end(), block);
  if (at == equations.blocks.end() || !(*at == block)) return equations.blocks.size();
  return static_cast<size_t>(at - equations.blocks.begin());
}

std::vector<int> RowsOf(const NormalEquations& equations, const std::vector<size_t>& blocks) {
  std::vector<int> rows;
  for (const size_t i : blocks) {
    for (int row = equations.offsets[i]; row < equations.offsets[i + 1]; ++row) {
      rows.push_back(row);
    }
  }
  return rows;
}

NormalEquations ZeroSystem(const std::map<BlockId, int>& sizes) {
  NormalEquations system;
  system.offsets.push_back(0);
  for (const auto& [block, size] : sizes) {
    system.blocks.push_back(block);
    system.offsets.push_back(system.offsets.back() + size);
  }
  system.hessian.setZero(system.size(), system.size());
  system.gradient.setZero(system.size());
  return system;
}

void AddTo(const NormalEquations& part,
           const std::vector<BlockId>& names,
           NormalEquations* system) {
  std::vector<int> rows;
  for (size_t i = 0; i < names.size(); ++i) {
    const size_t at = FindBlock(*system, names[i]);
    CHECK_LT(at, system->blocks.size());
    for (int k = 0; k < BlockSize(part, i); ++k) rows.push_back(system->offsets[at] + k);
  }
  for (size_t j = 0; j < rows.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    system->gradient[rows[j]] += part.gradient[column];
    for (size_t i = 0; i < rows.size(); ++i) {
      system->hessian(rows[i], rows[j]) += part.hessian(static_cast<Eigen::Index>(i), column);
    }
  }
}

}  // namespace plumbline
