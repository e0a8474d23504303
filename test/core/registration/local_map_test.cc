#include "core/registration/local_map.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

constexpr double kCell = 0.25;
const Eigen::Vector3d kScanner(-0.5, 0.2, 0.1);
const Eigen::Vector3d kLevel = Eigen::Vector3d::UnitZ();
const Eigen::Vector3d kTilted = Eigen::Vector3d(0.5, 0.5, std::sqrt(0.5));

// Points on the plane x = 1.1 within one cell, as sweeps of a tilted scanner cover it: rows of
// points that rise along y, one row a scan.
void AddSweeps(int num_scans, LocalMap* map) {
  for (int scan = 0; scan < num_scans; ++scan) {
    for (int i = 0; i < 8; ++i) {
      const double y = 0.03 * i;
      map->Add({1.1, 0.01 + y, 0.01 + 0.3 * y + 0.02 * scan}, kScanner, kTilted, scan, true);
    }
  }
}

TEST(LocalMap, ALineOfATiltedScannerGivesNoDirection) {
  LocalMap map(kCell, false, 0);
  for (int scan = 0; scan < 6; ++scan) {  // the rig stands: the same line again and again
    for (int i = 0; i < 8; ++i)
      map.Add({1.1, 0.01 + 0.03 * i, 0.1 + 0.01 * i}, kScanner, kTilted, scan, true);
  }
  const LocalCell* cell = map.Find({1.1, 0.1, 0.1}, kScanner);
  ASSERT_NE(cell, nullptr);
  EXPECT_EQ(cell->num_directions(), 0);
}

TEST(LocalMap, ManySweepsGiveTheSurfacesNormal) {
  LocalMap map(kCell, false, 0);
  AddSweeps(8, &map);
  const LocalCell* cell = map.Find({1.1, 0.1, 0.1}, kScanner);
  ASSERT_NE(cell, nullptr);
  ASSERT_EQ(cell->num_directions(), 1);
  EXPECT_NEAR(std::abs(cell->direction(0).normal.x()), 1.0, 1e-9);
  EXPECT_NEAR(cell->Mean().x(), 1.1, 1e-12);
  EXPECT_LT(cell->direction(0).variance, 1e-12);
}

TEST(LocalMap, ALevelLineIsTakenForAnUprightSurface) {
  LocalMap map(kCell, false, 0);
  for (int scan = 0; scan < 3; ++scan) {
    for (int i = 0; i < 8; ++i)
      map.Add({1.1, 0.01 + 0.03 * i, 0.1}, kScanner, kLevel, scan, true);
  }
  const LocalCell* cell = map.Find({1.1, 0.1, 0.1}, kScanner);
  ASSERT_NE(cell, nullptr);
  ASSERT_EQ(cell->num_directions(), 1);
  EXPECT_NEAR(std::abs(cell->direction(0).normal.x()), 1.0, 1e-9);
  EXPECT_EQ(cell->direction(0).normal.z(), 0.0);
}

TEST(LocalMap, APostIsKnownInBothDirectionsOfThePlan) {
  LocalMap map(kCell, true, 0);
  for (int scan = 0; scan < 3; ++scan) {
    for (int i = 0; i < 6; ++i) {
      map.Add({1.1 + 0.02 * std::cos(i), 0.1 + 0.02 * std::sin(i), 0.0},
              kScanner,
              kLevel,
              scan,
              true);
    }
  }
  ASSERT_NE(map.Find({1.1, 0.1, 0.0}, kScanner), nullptr);
  EXPECT_EQ(map.Find({1.1, 0.1, 0.0}, kScanner)->num_directions(), 2);
}

// Far along a wall one beam of a scan line meets the cell.
TEST(LocalMap, ASpotOnAWallIsNoPost) {
  for (const int points_per_scan : {1, 4}) {
    LocalMap map(kCell, false, 0);
    for (int scan = 0; scan < 8; ++scan) {
      for (int i = 0; i < points_per_scan; ++i) {
        map.Add({1.1 + 0.005 * (scan % 2), 0.1 + 0.02 * std::sin(scan + i), 0.1},
                kScanner,
                kLevel,
                scan,
                true);
      }
    }
    const LocalCell* cell = map.Find({1.1, 0.1, 0.1}, kScanner);
    ASSERT_NE(cell, nullptr);
    EXPECT_EQ(cell->num_directions(), points_per_scan == 1 ? 1 : 2);
  }
}

// A wall of 0.1 m whose two sides lie in one cell.
TEST(LocalMap, AWallHasTwoSides) {
  const Eigen::Vector3d behind(2.5, 0.2, 0.1);
  LocalMap map(kCell, false, 0);
  AddSweeps(8, &map);
  EXPECT_EQ(map.Find({1.2, 0.1, 0.1}, behind), nullptr);
  for (int scan = 8; scan < 16; ++scan) {
    for (int i = 0; i < 8; ++i) {
      const double y = 0.03 * i;
      map.Add(
          {1.2, 0.01 + y, 0.01 + 0.3 * y + 0.02 * (scan - 8)}, behind, kTilted, scan, true);
    }
  }
  const LocalCell* front = map.Find({1.1, 0.1, 0.1}, kScanner);
  const LocalCell* back = map.Find({1.2, 0.1, 0.1}, behind);
  ASSERT_NE(front, nullptr);
  ASSERT_NE(back, nullptr);
  EXPECT_NEAR(front->Mean().x(), 1.1, 1e-12);
  EXPECT_NEAR(back->Mean().x(), 1.2, 1e-12);
  EXPECT_LT(front->direction(0).normal.x(), -0.99);
  EXPECT_GT(back->direction(0).normal.x(), 0.99);
}

TEST(LocalMap, OneScanAloneTellsNothing) {
  LocalMap map(kCell, true, 0);
  for (int i = 0; i < 20; ++i) map.Add({1.1, 0.01 + 0.01 * i, 0.0}, kScanner, kLevel, 0, true);
  EXPECT_EQ(map.Find({1.1, 0.1, 0.0}, kScanner), nullptr);
}

// A cell that followed the poses could not hold them.
TEST(LocalMap, ACellThatHasSeenEnoughStaysWhereItIs) {
  LocalMap map(kCell, false, 0);
  AddSweeps(8, &map);
  const double before = map.Find({1.1, 0.1, 0.1}, kScanner)->Mean().x();
  for (int scan = 8; scan < 40; ++scan) {
    for (int i = 0; i < 8; ++i) map.Add({1.15, 0.03 * i, 0.1}, kScanner, kTilted, scan, true);
  }
  EXPECT_EQ(map.Find({1.1, 0.1, 0.1}, kScanner)->Mean().x(), before);
  EXPECT_EQ(map.Find({1.1, 0.1, 0.1}, kScanner)->last_scan(), 39);
}

// Somebody who walks along is nowhere for long.
TEST(LocalMap, ACellCountsOnceItHasAge) {
  LocalMap map(kCell, false, 6);
  AddSweeps(6, &map);
  EXPECT_EQ(map.Find({1.1, 0.1, 0.1}, kScanner), nullptr);
  for (int i = 0; i < 8; ++i) map.Add({1.1, 0.01 + 0.03 * i, 0.1}, kScanner, kTilted, 6, true);
  EXPECT_NE(map.Find({1.1, 0.1, 0.1}, kScanner), nullptr);
}

TEST(LocalMap, FoundsNoCellsWhereItMayNot) {
  LocalMap map(kCell, true, 0);
  for (int scan = 0; scan < 3; ++scan) {
    for (int i = 0; i < 8; ++i)
      map.Add({1.1, 0.01 + 0.03 * i, 0.0}, kScanner, kLevel, scan, scan > 0);
  }
  EXPECT_NE(map.Find({1.1, 0.1, 0.0}, kScanner), nullptr);
  for (int scan = 3; scan < 6; ++scan) {
    for (int i = 0; i < 8; ++i)
      map.Add({-3.1, 0.01 + 0.03 * i, 0.0}, kScanner, kLevel, scan, false);
  }
  EXPECT_EQ(map.Find({-3.1, 0.1, 0.0}, kScanner), nullptr);
}

TEST(LocalMap, ForgetsWhatWasNotSeenForLong) {
  LocalMap map(kCell, true, 0);
  for (int scan = 0; scan < 3; ++scan) {
    for (int i = 0; i < 8; ++i)
      map.Add({1.1, 0.01 + 0.03 * i, 0.0}, kScanner, kLevel, scan, true);
    for (int i = 0; i < 8; ++i)
      map.Add({-3.1, 0.01 + 0.03 * i, 0.0}, kScanner, kLevel, scan + 10, true);
  }
  map.ForgetBefore(5);
  EXPECT_EQ(map.Find({1.1, 0.1, 0.0}, kScanner), nullptr);
  EXPECT_NE(map.Find({-3.1, 0.1, 0.0}, kScanner), nullptr);
}

}  // namespace
}  // namespace plumbline
