#include "core/registration/occupancy_grid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

constexpr double kCell = 0.2;    // m
constexpr double kMargin = 0.1;  // m

class OccupancyGridTest : public testing::Test {
 protected:
  // Beams from the origin, fanned in the plan, that end on the wall x = 4.05.
  void SeeTheWall(int num_scans, int first_scan = 0) {
    for (int scan = first_scan; scan < first_scan + num_scans; ++scan) {
      for (int beam = -100; beam <= 100; ++beam) {
        const double y = 0.01 * beam;
        grid_.AddBeam({0.0, 0.0, 0.1}, {4.05, y, 0.1}, true, scan);
      }
    }
  }

  OccupancyGrid grid_{kCell};
};

TEST_F(OccupancyGridTest, IsEmptyWhereBeamsPassed) {
  SeeTheWall(10);
  EXPECT_TRUE(grid_.IsEmpty({2.0, 0.0, 0.1}, kMargin));
  EXPECT_TRUE(grid_.IsEmpty({3.0, -0.5, 0.1}, kMargin));
}

TEST_F(OccupancyGridTest, IsNotEmptyOnTheWallNorBehindItNorUnseen) {
  SeeTheWall(10);
  EXPECT_FALSE(grid_.IsEmpty({4.05, 0.3, 0.1}, kMargin));
  EXPECT_FALSE(grid_.IsEmpty({3.95, 0.3, 0.1}, kMargin)) << "within the margin of the wall";
  EXPECT_FALSE(grid_.IsEmpty({4.5, 0.0, 0.1}, kMargin));
  EXPECT_FALSE(grid_.IsEmpty({2.0, 3.0, 0.1}, kMargin));
  EXPECT_FALSE(grid_.IsEmpty({2.0, 0.0, 1.1}, kMargin));
}

TEST_F(OccupancyGridTest, FewBeamsSayNothing) {
  for (int beam = 0; beam < 3; ++beam) {
    grid_.AddBeam({0.0, 0.0, 0.1}, {4.05, 0.0, 0.1}, true, beam);
  }
  EXPECT_FALSE(grid_.IsEmpty({2.0, 0.0, 0.1}, kMargin));
}

// Every cell between the ends counts each beam once, whatever way the beam runs.
TEST_F(OccupancyGridTest, BeamsPassInAllDirections) {
  const Eigen::Vector3d from(0.31, -0.17, 0.05);
  for (const Eigen::Vector3d& to : {Eigen::Vector3d(-2.3, 1.1, 0.9),
                                    Eigen::Vector3d(0.31, -3.0, 0.05),
                                    Eigen::Vector3d(1.7, 2.9, -2.1)}) {
    OccupancyGrid grid(kCell);
    for (int scan = 0; scan < 10; ++scan) grid.AddBeam(from, to, true, scan);
    for (const double share : {0.1, 0.5, 0.8}) {
      EXPECT_TRUE(grid.IsEmpty(from + share * (to - from), 0.0)) << share;
    }
    EXPECT_FALSE(grid.IsEmpty(to, 0.0));
  }
}

TEST_F(OccupancyGridTest, AnEndThatDoesNotCountLeavesThePlaceEmpty) {
  SeeTheWall(10);
  for (int scan = 10; scan < 20; ++scan) {
    grid_.AddBeam({0.0, 0.0, 0.1}, {2.0, 0.0, 0.1}, false, scan);
  }
  EXPECT_TRUE(grid_.IsEmpty({2.0, 0.0, 0.1}, kMargin));
}

TEST_F(OccupancyGridTest, ForgetsWhatWasNotSeenForLong) {
  SeeTheWall(10);
  grid_.ForgetBefore(10);
  EXPECT_FALSE(grid_.IsEmpty({2.0, 0.0, 0.1}, kMargin));
  SeeTheWall(10, 10);
  grid_.ForgetBefore(10);
  EXPECT_TRUE(grid_.IsEmpty({2.0, 0.0, 0.1}, kMargin));
}

}  // namespace
}  // namespace plumbline
