#include "core/judging/passages.h"

#include <gtest/gtest.h>

#include <vector>

#include "test/core/judging/hand_made_map.h"

namespace plumbline {
namespace {

SharesOverTime PassagesOf(HandMadeMap* map) {
  return FindContradictedPassages(map->state(), CollectSightings(map->rig(), map->state(), 0))
      .shares;
}

TEST(PassagesTest, AWallThatIsSeenAgainIsNoContradiction) {
  HandMadeMap map;
  const int wall = map.AddWall(5.0, -2.0, 2.0);
  for (int second = 0; second < 8; ++second) map.See(second, wall, 5.0, -2.0, 2.0);
  const SharesOverTime shares = PassagesOf(&map);
  ASSERT_EQ(shares.size(), 8u);
  for (const Share& share : shares) {
    EXPECT_GT(share.comparable, 4.0);
    EXPECT_EQ(share.contradicted, 0.0);
  }
}

TEST(PassagesTest, BeamsThroughAWallOfOtherTimesContradictIt) {
  HandMadeMap map;
  const int wall = map.AddWall(5.0, -2.3, 2.4);
  const int behind = map.AddWall(8.0, -3.5, 3.7);
  for (int second = 0; second < 4; ++second) map.See(second, wall, 5.0, -1.9, 2.1);
  // The same beams go on to the wall behind.
  for (int second = 4; second < 8; ++second) map.See(second, behind, 8.0, -3.04, 3.36);
  const SharesOverTime shares = PassagesOf(&map);
  // Of the five or six other seconds that say anything of a cell, four say the contrary; the
  // wall behind is contradicted by none.
  EXPECT_NEAR(Smoothed(shares, 1).value(), (4.0 / 6.0 + 4.0 / 5.0 + 4.0 / 5.0) / 3.0, 1e-9);
  EXPECT_NEAR(Smoothed(shares, 6).value(), (4.0 / 6.0 + 4.0 / 5.0 + 4.0 / 5.0) / 6.0, 1e-9);
}

// Doors that are closed for four seconds, with a wall behind that is seen through them later.
// can_move: otherwise they are planes of a kind that holds no doors.
ContradictedPassages ThroughDoors(const std::vector<double>& doors_x, bool can_move = true) {
  HandMadeMap map;
  std::vector<int> doors;
  for (const double x : doors_x) {
    doors.push_back(map.AddWall(x, -2.3, 2.4));
    if (can_move) continue;
    Landmark& landmark = map.state().landmarks.back();
    Landmark slope = MakeGeneralLandmark({-1.0, 0.0, 0.0}, {x, 0.0, 0.0});
    slope.id = landmark.id;
    slope.num_segments = 1;
    slope.extent.AddSegment({x, -2.3, 0.0}, {x, 2.4, 0.0});
    landmark = slope;
  }
  const int behind = map.AddWall(8.0, -3.5, 3.7);
  for (int second = 0; second < 4; ++second) {
    for (size_t i = 0; i < doors.size(); ++i) {
      map.See(second, doors[i], doors_x[i], -1.9, 2.1);
    }
  }
  for (int second = 4; second < 8; ++second) map.See(second, behind, 8.0, -3.04, 3.36);
  return FindContradictedPassages(map.state(), CollectSightings(map.rig(), map.state(), 0));
}

TEST(PassagesTest, OneSurfaceAloneContradictsNoneOfTheOthers) {
  const ContradictedPassages of_one = ThroughDoors({5.0});
  EXPECT_GT(of_one.shares[6].contradicted, 1.0);
  EXPECT_EQ(of_one.without_worst[6].contradicted, 0.0);
  EXPECT_GT(of_one.without_worst[6].comparable, 0.0) << "the wall behind";
  EXPECT_GT(ThroughDoors({5.0, 6.0}).without_worst[6].contradicted, 1.0);
}

TEST(PassagesTest, ASurfaceThatHoldsNoDoorsCountsAlone) {
  EXPECT_GT(ThroughDoors({5.0}, false).without_worst[6].contradicted, 1.0);
}

TEST(PassagesTest, BeamsThatEndCloseBehindDoNotPass) {
  HandMadeMap map;
  const int wall = map.AddWall(5.0, -2.0, 2.0);
  const int behind = map.AddWall(5.03, -2.0, 2.0);
  for (int second = 0; second < 4; ++second) map.See(second, wall, 5.0, -2.0, 2.0);
  for (int second = 4; second < 8; ++second) map.See(second, behind, 5.03, -2.0, 2.0);
  for (const Share& share : PassagesOf(&map)) EXPECT_EQ(share.contradicted, 0.0);
}

TEST(PassagesTest, AnOpeningThatIsSeenThroughInTheSameSecondsIsNone) {
  HandMadeMap map;
  const int wall = map.AddWall(5.0, -2.0, 2.0);
  const int behind = map.AddWall(8.0, -2.0, 2.0);
  for (int second = 0; second < 8; ++second) {
    map.See(second, wall, 5.0, 1.0, 2.0);
    map.See(second, behind, 8.0, -2.0, -0.5);
  }
  for (const Share& share : PassagesOf(&map)) EXPECT_EQ(share.contradicted, 0.0);
}

}  // namespace
}  // namespace plumbline
