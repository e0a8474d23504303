#pragma once

#include <tuple>
#include <vector>

namespace plumbline {

// The unknowns of an estimation. Blocks sort as control points and biases of the IMU by time,
// then landmarks by id, then scanners, then the IMU; every matrix of ours has its rows and
// columns in this order.
struct BlockId {
  enum class Kind {
    kRotation,
    kPosition,
    kLandmark,
    kScanner,
    kImu,
    kGyroscopeBias,
    kAccelerometerBias
  };
  int group = 0;  // 0: control points and biases, 1: landmarks, 2: scanners, 3: the IMU
  // Index of a control point or scanner, id of a landmark, or last knot interval that a bias
  // has a say in.
  int index = 0;
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

inline BlockId ImuBlockId() { return {3, 0, BlockId::Kind::kImu}; }
inline BlockId GyroscopeBiasBlock(int last_interval) {
  return {0, last_interval, BlockId::Kind::kGyroscopeBias};
}
inline BlockId AccelerometerBiasBlock(int last_interval) {
  return {0, last_interval, BlockId::Kind::kAccelerometerBias};
}

inline bool IsLandmark(const BlockId& block) { return block.kind == BlockId::Kind::kLandmark; }
inline bool IsScanner(const BlockId& block) { return block.kind == BlockId::Kind::kScanner; }
inline bool IsControlPoint(const BlockId& block) {
  return block.kind == BlockId::Kind::kRotation || block.kind == BlockId::Kind::kPosition;
}

inline bool IsImu(const BlockId& block) { return block.kind == BlockId::Kind::kImu; }
inline bool IsBias(const BlockId& block) {
  return block.kind == BlockId::Kind::kGyroscopeBias ||
         block.kind == BlockId::Kind::kAccelerometerBias;
}
// Whether only what lies near in time depends on the block.
inline bool IsOfTime(const BlockId& block) { return IsControlPoint(block) || IsBias(block); }
// Whether nothing that begins with this control point or later depends on the block.
inline bool IsBefore(const BlockId& block, int control_point) {
  return IsOfTime(block) && block.index < control_point;
}

// A problem's blocks and their columns, in the blocks' full tangent spaces as in
// NormalEquations.
struct BlockLayout {
  std::vector<BlockId> blocks;
  std::vector<int> offsets;   // first column of each block; the last element is their number
  std::vector<bool> is_free;  // of each column: not held by a manifold

  int size() const { return offsets.back(); }
  // Number of columns of what lies in time. They come first, those of landmarks and scanners
  // after them.
  int NumBandColumns() const;
  // First column of a block that is there.
  int ColumnOf(const BlockId& block) const;
  // Number of columns from the biases of one node to those of the next, these included; 0
  // without. In tiles of as many each node's biases end a tile.
  int WidthOfBiases() const;
  std::vector<int> FreeColumns() const;
};

}  // namespace plumbline
