#include "core/outputs/beam_evidence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/testing/test_files.h"

namespace plumbline {
namespace {

using ::testing::AllOf;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Le;

Eigen::AlignedBox2d Square(double side_m) {
  return {Eigen::Vector2d(-1.0, -1.0), Eigen::Vector2d(side_m - 1.0, side_m - 1.0)};
}

TEST(FreeGrid, SquaresThatTwoBeamsPassedAreFree) {
  FreeGrid grid(Square(4.0));
  grid.AddBeam({-0.5, 0.02}, {1.5, 0.02});
  EXPECT_EQ(grid.CountFree(20, 0, 80), 0);
  grid.AddBeam({0.5, 0.02}, {5.0, 0.02});
  // From 0.5 to 1.5 m along x, in squares of 5 cm; the ends of beams may miss one.
  EXPECT_THAT(grid.CountFree(20, 0, 80), AllOf(Ge(19), Le(21)));
  EXPECT_EQ(grid.CountFree(21, 0, 80), 0);
  EXPECT_EQ(grid.CountFree(20, 0, 30), 0);
  EXPECT_EQ(grid.CountFree(20, 35, 40), 5);
}

TEST(FreeGrid, ABoxOfKilometresTakesMemoryWhereBeamsAre) {
  // As one array, it would have 6.4 billion squares.
  FreeGrid grid(Square(4000.0));
  for (int i = 0; i < 2; ++i) grid.AddBeam({3000.0, 3000.02}, {3010.0, 3000.02});
  EXPECT_THAT(grid.CountFree(60020, 0, 80000), AllOf(Ge(199), Le(201)));
}

TEST(FreeGrid, NoBuildingIsLargerThanFiveKilometres) {
  EXPECT_THAT(ErrorOf([] { FreeGrid(Square(6000.0)); }),
              HasSubstr("walls lie up to 6000 m apart, farther than those of any building"));
}

}  // namespace
}  // namespace plumbline
