#pragma once

#include <array>
#include <cstdint>

namespace plumbline {

// Bits of a key for each index of a cell: indices from -2^20 to 2^20 - 1, 26 km with cells of
// 1.25 cm.
inline constexpr int kIndexBits = 21;

// The key of a cell of a sparse grid in space.
inline uint64_t CellKey(const std::array<int64_t, 3>& cell) {
  uint64_t key = 0;
  for (const int64_t index : cell) {
    key = (key << kIndexBits) |
          (static_cast<uint64_t>(index) & ((uint64_t{1} << kIndexBits) - 1));
  }
  return key;
}

// The cell of a key.
inline std::array<int64_t, 3> CellOfKey(uint64_t key) {
  std::array<int64_t, 3> cell;
  for (int axis = 2; axis >= 0; --axis, key >>= kIndexBits) {
    // The shift to the right brings the index's sign along.
    cell[static_cast<size_t>(axis)] =
        static_cast<int64_t>(key << (64 - kIndexBits)) >> (64 - kIndexBits);
  }
  return cell;
}

}  // namespace plumbline
