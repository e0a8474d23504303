#include "core/estimation/block_layout.h"

#include <cstddef>

namespace plumbline {

int BlockLayout::NumControlPointColumns() const {
  for (size_t i = 0; i < blocks.size(); ++i) {
    if (!IsControlPoint(blocks[i])) return offsets[i];
  }
  return size();
}

std::vector<int> BlockLayout::FreeColumns() const {
  std::vector<int> free;
  for (int column = 0; column < size(); ++column) {
    if (is_free[static_cast<size_t>(column)]) free.push_back(column);
  }
  return free;
}

}  // namespace plumbline
