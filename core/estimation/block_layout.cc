#include "core/estimation/block_layout.h"

#include <glog/logging.h>

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace plumbline {

int BlockLayout::NumBandColumns() const {
  for (size_t i = 0; i < blocks.size(); ++i) {
    if (!IsOfTime(blocks[i])) return offsets[i];
  }
  return size();
}

int BlockLayout::ColumnOf(const BlockId& block) const {
  const auto at = std::lower_bound(blocks.begin(), blocks.end(), block);
  CHECK(at != blocks.end() && *at == block);
  return offsets[static_cast<size_t>(std::distance(blocks.begin(), at))];
}

int BlockLayout::WidthOfBiases() const {
  int width = 0;
  int end = 0;
  for (size_t i = 0; i < blocks.size(); ++i) {
    if (!IsBias(blocks[i])) continue;
    const bool goes_on = i + 1 < blocks.size() && IsBias(blocks[i + 1]) &&
                         blocks[i + 1].index == blocks[i].index;
    if (goes_on) continue;
    width = std::max(width, offsets[i + 1] - end);
    end = offsets[i + 1];
  }
  return width;
}

std::vector<int> BlockLayout::FreeColumns() const {
  std::vector<int> free;
  for (int column = 0; column < size(); ++column) {
    if (is_free[static_cast<size_t>(column)]) free.push_back(column);
  }
  return free;
}

}  // namespace plumbline
