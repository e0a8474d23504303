#include "core/estimation/arrowhead_matrix.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(PositionsOf, FindsEachVariable) {
  EXPECT_EQ(PositionsOf({3, 9}, {1, 3, 4, 9}), (std::vector<int>{1, 3}));
  EXPECT_TRUE(PositionsOf({}, {1}).empty());
}

TEST(PositionsOfDeathTest, DoesNotTakeOneThatIsMissing) {
  EXPECT_DEATH(PositionsOf({2}, {1, 3}), "Check failed.*variable.* 2");
}

TEST(ArrowheadTile, KeepsWhatItHasWhenVariablesCome) {
  ArrowheadTile tile;
  tile.diagonal.setZero(2, 2);
  tile.border.resize(0, 2);
  tile.AddBorder({5}, Eigen::RowVector2d(1.0, 2.0));
  tile.AddBorder({3, 5}, (Eigen::Matrix2d() << 3.0, 4.0, 10.0, 20.0).finished());
  EXPECT_EQ(tile.seen, (std::vector<int>{3, 5}));
  EXPECT_EQ(tile.border, (Eigen::Matrix2d() << 3.0, 4.0, 11.0, 22.0).finished());
}

TEST(ArrowheadMatrix, CountsBandAndBorder) { EXPECT_EQ(ArrowheadMatrix(7, 3, 2).size(), 9); }

TEST(ArrowheadMatrixDeathTest, HoldsNothingOutsideOfTheBand) {
  ArrowheadMatrix matrix(9, 3, 1);
  matrix.AddBlock({2, 5}, Eigen::Matrix2d::Identity());  // adjacent tiles
  EXPECT_DEATH(matrix.AddBlock({2, 6}, Eigen::Matrix2d::Identity()), "outside the band");
}

}  // namespace
}  // namespace plumbline
