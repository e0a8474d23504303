#include "core/estimation/arrowhead_inverse.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

constexpr int kTileSize = 3;

// A symmetric matrix whose entries all differ, by its rows and columns.
double EntryAt(int row, int column) {
  return 10.0 * std::max(row, column) + std::min(row, column);
}

Eigen::MatrixXd BlockAt(int first_row, int first_column, int rows, int columns) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&](Eigen::Index i, Eigen::Index j) {
    return EntryAt(first_row + static_cast<int>(i), first_column + static_cast<int>(j));
  });
}

// A band of eight variables, the last tile smaller, and a border of two.
ArrowheadInverse MakeInverse() {
  std::vector<ArrowheadTile> tiles;
  for (const int first : {0, 3, 6}) {
    const int size = first < 6 ? kTileSize : 2;
    const int num_next = first == 0 ? kTileSize : first == 3 ? 2 : 0;
    ArrowheadTile tile;
    tile.first = first;
    tile.diagonal = BlockAt(first, first, size, size);
    tile.next = BlockAt(first + kTileSize, first, num_next, size);
    tiles.push_back(tile);
  }
  return ArrowheadInverse(kTileSize, std::move(tiles), BlockAt(8, 8, 2, 2));
}

TEST(ArrowheadInverseTest, GivesBlocksWithinAndAcrossTiles) {
  const ArrowheadInverse inverse = MakeInverse();
  for (int size = 1; size <= kTileSize + 1; ++size) {
    for (int first = 0; first + size <= 8; ++first) {
      EXPECT_EQ(inverse.BandBlock(first, size), BlockAt(first, first, size, size))
          << size << " from " << first;
    }
  }
  EXPECT_EQ(inverse.border(), BlockAt(8, 8, 2, 2));
}

TEST(ArrowheadInverseDeathTest, HoldsNoBlockOfThreeTiles) {
  EXPECT_DEATH(MakeInverse().BandBlock(2, 6), "outside the band");
}

// A variable that no other depends on has its variance alone; others keep theirs.
TEST(ArrowheadInverseTest, ClearsVariablesThatStandAlone) {
  std::vector<ArrowheadTile> tiles(2);
  tiles[0].diagonal = 2.0 * Eigen::MatrixXd::Identity(2, 2);
  tiles[0].next = Eigen::MatrixXd::Zero(1, 2);
  tiles[1].first = 2;
  tiles[1].diagonal = 2.0 * Eigen::MatrixXd::Identity(1, 1);
  ArrowheadInverse inverse(2, std::move(tiles), 2.0 * Eigen::MatrixXd::Identity(2, 2));
  inverse.Clear(2);
  inverse.Clear(3);
  const Eigen::Vector3d band(2.0, 2.0, 0.0);
  const Eigen::Vector2d border(0.0, 2.0);
  EXPECT_EQ(inverse.BandBlock(0, 3), Eigen::MatrixXd(band.asDiagonal()));
  EXPECT_EQ(inverse.border(), Eigen::MatrixXd(border.asDiagonal()));
}

}  // namespace
}  // namespace plumbline
