#include "core/surface/cell_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "core/util/error.h"

namespace plumbline {
namespace {

TEST(CellIndex, IsTheFloor) {
  for (const double coordinate : {-2.0, -1.5, -1.0, -0.25, 0.0, 0.25, 1.0, 1.75}) {
    EXPECT_EQ(CellIndex(coordinate), static_cast<int>(std::floor(coordinate))) << coordinate;
  }
}

TEST(CellGrid, CountsLikeAMap) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> coordinate(-40, 25);
  CellGrid grid;
  std::map<CellGrid::Cell, int> expected;
  for (int i = 0; i < 500; ++i) {
    const CellGrid::Cell cell(coordinate(random), coordinate(random));
    grid.Add(cell, 1 + i % 3);
    expected[cell] += 1 + i % 3;
  }
  EXPECT_EQ(grid.num_occupied(), static_cast<int>(expected.size()));
  std::map<CellGrid::Cell, int> found;
  grid.Any([&](const CellGrid::Cell& cell, int count) {
    found[cell] = count;
    return false;
  });
  EXPECT_EQ(found, expected);
  EXPECT_EQ(grid.Count({-100, 3}), 0);
}

TEST(CellGrid, NearMeansWithinReachInBothDirections) {
  CellGrid grid;
  EXPECT_FALSE(grid.IsNear({0, 0}, 1000));
  grid.Add({5, -3}, 1);
  EXPECT_TRUE(grid.IsNear({7, -5}, 2));
  EXPECT_FALSE(grid.IsNear({8, -3}, 2));
  EXPECT_FALSE(grid.IsNear({5, 0}, 2));
}

TEST(CellGrid, AnyStopsWhereItIsTold) {
  CellGrid grid;
  for (int i = 0; i < 5; ++i) grid.Add({i, 0}, 1);
  int visited = 0;
  EXPECT_TRUE(grid.Any([&](const CellGrid::Cell& cell, int) {
    ++visited;
    return cell.first == 2;
  }));
  EXPECT_EQ(visited, 3);
}

TEST(CellGrid, ACountStaysAtTheLargest) {
  CellGrid grid;
  for (const int count : {CellGrid::kMaxCount - 1, 2, 1'000'000'000}) grid.Add({2, 3}, count);
  EXPECT_EQ(grid.Count({2, 3}), CellGrid::kMaxCount);
  grid.Add({-50, 40}, 1);  // into a larger rectangle
  EXPECT_EQ(grid.Count({2, 3}), CellGrid::kMaxCount);
  EXPECT_EQ(grid.num_occupied(), 2);
}

TEST(CellGrid, RaisingNeverLowersACount) {
  CellGrid grid;
  for (const int count : {2, 3, 1}) grid.Raise({4, -1}, count);
  EXPECT_EQ(grid.Count({4, -1}), 3);
  EXPECT_EQ(grid.num_occupied(), 1);
}

TEST(CellGrid, AnAbsurdRectangleIsAnError) {
  CellGrid grid;
  grid.Add({0, 0}, 1);
  EXPECT_THROW(grid.Add({100'000, 100'000}, 1), Error);
}

}  // namespace
}  // namespace plumbline
