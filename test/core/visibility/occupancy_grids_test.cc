#include "core/visibility/occupancy_grids.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

// A wall along x; u runs along it, v upwards.
class OccupancyGridsTest : public ::testing::Test {
 protected:
  OccupancyGridsTest() : wall_(MakeVerticalLandmark({0.0, -1.0, 0.0}, {0.0, 2.0, 0.0})) {
    wall_.extent.AddSegment(At(-3.0), At(3.0));
    wall_.extent.AddSegment(At(-3.0, 1.0), At(3.0, 1.0));
  }

  bool HasOpenings() const { return !openings_.OpeningsOf(wall_).none(); }
  bool IsOpening(const Eigen::Vector3d& p_world) const {
    return openings_.OpeningsOf(wall_).IsAt(p_world);
  }
  static Eigen::Vector3d At(double x, double z = 0.01) { return {x, 2.0, z}; }

  Landmark wall_;
  OccupancyGrids openings_;
};

TEST_F(OccupancyGridsTest, WhereNothingWasCountedIsNoOpening) {
  EXPECT_FALSE(HasOpenings());
  EXPECT_FALSE(IsOpening(At(1.0)));
  openings_.CountHit(wall_, At(1.0));
  EXPECT_FALSE(HasOpenings());
}

TEST_F(OccupancyGridsTest, InThePlanesAxesTheAnswerIsTheSame) {
  for (int i = 0; i < 2; ++i) openings_.CountPassage(wall_, At(1.01));
  const PlaneOpenings openings = openings_.OpeningsOf(wall_);
  // A level scan plane that lies askew: x towards the wall, y along it backwards.
  ScanPlacement placement;
  placement << 0.0, -1.0, 0.4,  //
      1.0, 0.0, 0.5,            //
      0.0, 0.0, 0.01;
  for (const double x : {0.5, 1.01, 1.5}) {
    const Eigen::Vector2d p(2.0 - 0.5, 0.4 - x);
    EXPECT_EQ(openings.IsAtLocal(openings.OnAxes(placement) * p.homogeneous().eval()),
              x == 1.01);
    EXPECT_EQ(openings.IsAt(placement * p.homogeneous()), x == 1.01);
  }
}

TEST_F(OccupancyGridsTest, BeamsThatGoThroughMakeOneHereAndAtTheNextCell) {
  openings_.CountPassage(wall_, At(1.01));
  EXPECT_FALSE(IsOpening(At(1.01))) << "once is not enough";
  openings_.CountPassage(wall_, At(1.01));
  EXPECT_TRUE(HasOpenings());
  EXPECT_TRUE(IsOpening(At(1.01)));
  EXPECT_TRUE(IsOpening(At(1.03, 0.2))) << "0.02 m aside, at its height";
  EXPECT_FALSE(IsOpening(At(1.07, 0.2)));
  EXPECT_FALSE(IsOpening(At(1.01, 0.6)));
}

TEST_F(OccupancyGridsTest, WhatAnotherHasCountedAddsUp) {
  const auto openings_of = [&](int passages, int hits) {
    OccupancyGrids map;
    for (int i = 0; i < passages; ++i) map.CountPassage(wall_, At(1.01));
    for (int i = 0; i < hits; ++i) map.CountHit(wall_, At(1.01));
    return map;
  };
  OccupancyGrids sum;
  sum.Add(openings_of(1, 0));
  EXPECT_FALSE(sum.OpeningsOf(wall_).IsAt(At(1.01)));
  sum.Add(openings_of(1, 0));
  EXPECT_TRUE(sum.OpeningsOf(wall_).IsAt(At(1.01)));
  sum.Add(openings_of(0, 30));
  EXPECT_FALSE(sum.OpeningsOf(wall_).IsAt(At(1.01))) << "less than a tenth went through";
}

// A door's edge does not end where beams no longer tell of it.
TEST_F(OccupancyGridsTest, GoesOnAlongItsEdgeUnlessBeamsTellOtherwise) {
  for (int i = 0; i < 5; ++i) openings_.CountPassage(wall_, At(1.01, 0.1));
  EXPECT_TRUE(IsOpening(At(1.01, 0.3)));
  EXPECT_FALSE(IsOpening(At(1.01, 0.6))) << "not for two cells";
  openings_.CountHit(wall_, At(1.01, 0.3));
  EXPECT_TRUE(IsOpening(At(1.01, 0.3))) << "one against five";
  openings_.CountHit(wall_, At(1.01, 0.3));
  EXPECT_FALSE(IsOpening(At(1.01, 0.3)));
}

// A cell of 0.25 m that lies across an upright edge sees both what it lets through and what it
// does not: the narrow ones of the other kind tell where the edge is.
TEST_F(OccupancyGridsTest, AnUprightEdgeIsKnownToItsNarrowCells) {
  for (double z = 0.0; z < 0.75; z += 0.01) {
    for (double x = 0.01; x < 0.25; x += 0.02) {
      if (x < 0.16) {
        openings_.CountHit(wall_, At(x, z));
      } else {
        openings_.CountPassage(wall_, At(x, z));
      }
    }
  }
  for (const double z : {0.05, 0.35, 0.65}) {
    EXPECT_FALSE(IsOpening(At(0.03, z)));
    EXPECT_FALSE(IsOpening(At(0.09, z)));
    EXPECT_TRUE(IsOpening(At(0.15, z))) << "the last one before the edge";
    EXPECT_TRUE(IsOpening(At(0.19, z)));
  }
}

TEST_F(OccupancyGridsTest, ALevelEdgeIsKnownToItsNarrowCells) {
  for (double x = 0.0; x < 0.75; x += 0.01) {
    for (double z = 0.01; z < 0.25; z += 0.02) {
      if (z > 0.1) {
        openings_.CountHit(wall_, At(x, z));
      } else {
        openings_.CountPassage(wall_, At(x, z));
      }
    }
  }
  for (const double x : {0.05, 0.35, 0.65}) {
    EXPECT_TRUE(IsOpening(At(x, 0.07)));
    EXPECT_TRUE(IsOpening(At(x, 0.11))) << "the first one beyond the edge";
    EXPECT_FALSE(IsOpening(At(x, 0.17)));
    EXPECT_FALSE(IsOpening(At(x, 0.23)));
  }
}

// Beams on a jamb lie where others go through, and no beam may have gone through beside them.
TEST_F(OccupancyGridsTest, WhereMostGoThroughABeamBesideThemDoesNotMakeItSolid) {
  for (double z = 0.0; z < 0.25; z += 0.02) openings_.CountPassage(wall_, At(0.11, z));
  for (int i = 0; i < 3; ++i) openings_.CountHit(wall_, At(0.01, 0.11));
  EXPECT_TRUE(IsOpening(At(0.11, 0.11)));
}

TEST_F(OccupancyGridsTest, FarFromThePlaneNothingIsCounted) {
  for (int i = 0; i < 2; ++i) openings_.CountPassage(wall_, At(4.1));
  EXPECT_FALSE(HasOpenings());
}

// What noise makes of a wall: hardly any beam seems to go through.
TEST_F(OccupancyGridsTest, AWallThatFewBeamsMissIsNoOpening) {
  for (int i = 0; i < 3; ++i) openings_.CountPassage(wall_, At(1.01));
  for (int i = 0; i < 100; ++i) openings_.CountHit(wall_, At(1.01));
  EXPECT_FALSE(IsOpening(At(1.01)));
  EXPECT_FALSE(HasOpenings()) << "what is no opening does not count";
}

// Most beams that seem to lie on the wall where it is open are the jambs'.
TEST_F(OccupancyGridsTest, AsManyBeamsOnAJambDoNotCloseADoor) {
  for (int i = 0; i < 30; ++i) openings_.CountPassage(wall_, At(1.01));
  for (int i = 0; i < 30; ++i) openings_.CountHit(wall_, At(1.01));
  EXPECT_TRUE(IsOpening(At(1.01)));
}

TEST_F(OccupancyGridsTest, WhatPassesNoneIsToldSoQuickly) {
  for (int i = 0; i < 2; ++i) openings_.CountPassage(wall_, At(1.01, 0.6));
  const PlaneOpenings openings = openings_.OpeningsOf(wall_);
  EXPECT_TRUE(openings.MayBeAlong(At(-2.0, 0.6), At(2.0, 0.6)));
  EXPECT_TRUE(openings.MayBeAlong(At(2.0, 1.4), At(0.0, -0.2)));
  EXPECT_FALSE(openings.MayBeAlong(At(-2.0, 0.6), At(0.4, 0.6)));
  EXPECT_FALSE(openings.MayBeAlong(At(1.7, -0.6), At(1.7, 1.6)));
  // Wherever there is one, it may be.
  for (double x = 0.5; x < 1.5; x += 0.003) {
    for (double z = 0.1; z < 1.1; z += 0.017) {
      if (openings.IsAt(At(x, z))) {
        EXPECT_TRUE(openings.MayBeAlong(At(x - 1.0, z), At(x + 0.7, z)));
      }
    }
  }
}

TEST_F(OccupancyGridsTest, APlaceWhereBeamsDoNotLieOnThePlaneIsOne) {
  wall_.id = 0;
  for (int i = 0; i < 1000; ++i) {
    const double x = -2.99 + 0.006 * i;
    const bool is_before = x > 1.0 && x < 1.25;
    openings_.CountDeviation(wall_, At(x), is_before ? 0.04 : 0.0, 0.01);
  }
  std::vector<LevelOnSurface> levels;
  const PlaneOpenings openings = openings_.OpeningsOf({wall_}, 0.0, &levels)[0];
  EXPECT_TRUE(openings.IsAt(At(1.1)));
  EXPECT_FALSE(openings.IsAt(At(0.9)));
  EXPECT_FALSE(openings.IsAt(At(1.35)));
  EXPECT_TRUE(levels.empty()) << "of one cell";
  EXPECT_FALSE(IsOpening(At(1.1))) << "beams pass nowhere";
}

TEST_F(OccupancyGridsTest, ALevelHasTheRestAndItsEdgesAsOpenings) {
  wall_.id = 0;
  for (int i = 0; i < 1000; ++i) {
    const double x = -2.99 + 0.006 * i;
    for (const double z : {0.01, 1.01}) {
      openings_.CountDeviation(wall_, At(x, z), x > 1.0 ? 0.04 : 0.0, 0.01);
    }
  }
  std::vector<LevelOnSurface> levels;
  const PlaneOpenings openings = openings_.OpeningsOf({wall_}, 0.0, &levels)[0];
  ASSERT_EQ(levels.size(), 1u);
  EXPECT_EQ(levels[0].landmark_id, 0);
  EXPECT_NEAR(levels[0].step_m, 0.04, 0.002);
  EXPECT_FALSE(openings.IsAt(At(-1.0)));
  EXPECT_TRUE(openings.IsAt(At(1.1)));
  EXPECT_TRUE(openings.IsAt(At(2.9)));
  EXPECT_TRUE(levels[0].elsewhere.IsAt(At(-1.0)));
  EXPECT_TRUE(levels[0].elsewhere.IsAt(At(1.1))) << "the edge may run through that cell";
  EXPECT_FALSE(levels[0].elsewhere.IsAt(At(1.4)));
  EXPECT_FALSE(levels[0].elsewhere.IsAt(At(2.9)));
}

}  // namespace
}  // namespace plumbline
