#pragma once

#include <tuple>
#include <vector>

namespace plumbline {

// The unknowns of an estimation. Blocks sort as control points by time, then landmarks by id,
// then scanners; every matrix of ours has its rows and columns in this order.
struct BlockId {
  enum class Kind { kRotation, kPosition, kLandmark, kScanner };
  int group = 0;  // 0: control points, 1: landmarks, 2: scanners
  int index = 0;  // of a control point or scanner, or landmark id
  Kind kind = Kind::kRotation;

  bool operator<(const BlockId& other) const {
    return std::tie(group, index, kind) < std::tie(other.group, other.index, other.kind);
  }
  bool operator==(const BlockId& other) const {
    return group == other.group && index == other.index && kind == other.kind;
  }
};

inline BlockId RotationBlock(int control_point) {
  return {0, control_point, BlockId::Kind::kRotation};
}
inline BlockId PositionBlock(int control_point) {
  return {0, control_point, BlockId::Kind::kPosition};
}
inline BlockId LandmarkBlock(int id) { return {1, id, BlockId::Kind::kLandmark}; }

inline BlockId ScannerBlockId(int scanner) { return {2, scanner, BlockId::Kind::kScanner}; }

inline bool IsLandmark(const BlockId& block) { return block.kind == BlockId::Kind::kLandmark; }
inline bool IsScanner(const BlockId& block) { return block.kind == BlockId::Kind::kScanner; }
inline bool IsControlPoint(const BlockId& block) {
  return block.kind == BlockId::Kind::kRotation || block.kind == BlockId::Kind::kPosition;
}

// A problem's blocks and their columns, in the blocks' full tangent spaces as in
// NormalEquations.
struct BlockLayout {
  std::vector<BlockId> blocks;
  std::vector<int> offsets;   // first column of each block; the last element is their number
  std::vector<bool> is_free;  // of each column: not held by a manifold

  int size() const { return offsets.back(); }
  // They come first, those of landmarks and scanners after them.
  int NumControlPointColumns() const;
  std::vector<int> FreeColumns() const;
};

}  // namespace plumbline
