#include "core/registration/visit_grid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

// A wall 4 m before the scanner, 6 m wide.
Visit SeenWall() {
  Visit visit;
  for (double y = -3.0; y <= 3.0; y += 0.05) {
    visit.points.emplace_back(4.0, y);
    visit.scanners.emplace_back(0.0, 0.0);
  }
  return visit;
}

TEST(VisitGrid, TellsSurfacesFromFreeSpaceAndTheUnknown) {
  const VisitGrid grid(SeenWall());
  EXPECT_GT(grid.At(grid.CellOf({4.0, 0.5})), 80);
  EXPECT_LT(grid.At(grid.CellOf({2.0, 0.5})), 0);
  EXPECT_EQ(grid.At(grid.CellOf({4.7, 0.5})), 0);     // behind the wall
  EXPECT_EQ(grid.At(grid.CellOf({40.0, -40.0})), 0);  // far outside
}

TEST(VisitGrid, FitsLessTheFartherASurfaceIs) {
  const VisitGrid grid(SeenWall());
  EXPECT_GT(grid.At(grid.CellOf({4.0, 0.5})), grid.At(grid.CellOf({3.85, 0.5})));
}

// The search leaves out what the bounds rule out: no value within their reach may be larger.
TEST(VisitGrid, BoundsHoldForAllThatTheyReach) {
  const VisitGrid grid(SeenWall());
  const double cell = VisitGrid::kCell;
  const int coarse = VisitGrid::kCoarse;
  for (double x = -2.95; x < 6.0; x += 0.4) {
    for (double y = -4.95; y < 5.0; y += 0.4) {
      const Eigen::Vector2d p(x, y);
      for (int i = 0; i <= coarse * coarse; ++i) {
        for (int j = 0; j <= coarse * coarse; ++j) {
          const int value = grid.At(grid.CellOf(p + cell * Eigen::Vector2d(i, j)));
          if (i <= coarse && j <= coarse) {
            ASSERT_GE(grid.BoundAt(grid.CellOf(p)), value) << p.transpose();
          }
          ASSERT_GE(grid.CoarseBoundAt(grid.CellOf(p)), value) << p.transpose();
        }
      }
    }
  }
}

TEST(VisitGrid, KnowsNothingOfAVisitWithoutPoints) {
  EXPECT_EQ(VisitGrid(Visit()).At({0, 0}), 0);
}

}  // namespace
}  // namespace plumbline
