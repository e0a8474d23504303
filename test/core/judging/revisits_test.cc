#include "core/judging/revisits.h"

#include <gtest/gtest.h>

#include "test/core/judging/hand_made_map.h"

namespace plumbline {
namespace {

// A corner of two walls, seen at first and again after half a minute.
class RevisitsTest : public testing::Test {
 protected:
  RevisitsTest() {
    wall_ = map_.AddWall(5.0, -2.0, 2.0);
    Landmark side = MakeVerticalLandmark({0.0, -1.0, 0.0}, {0.0, 2.0, 0.0});
    side.id = 1;
    side.num_segments = 1;
    side.extent.AddSegment({1.0, 2.0, 0.0}, {5.0, 2.0, 0.0});
    map_.state().landmarks.push_back(side);
    for (int second = 0; second < 3; ++second) SeeCorner(second, 0.0, true);
  }
  // shift_x: of everything that is seen; on_planes: whether it was taken to lie on the planes.
  void SeeCorner(int second, double shift_x, bool on_planes) {
    for (int i = 0; i < 4; ++i) {
      const double from = -1.8 + 0.9 * i;
      map_.SeeAlong(
          second, on_planes ? wall_ : -1, {5.0 + shift_x, from}, {5.0 + shift_x, from + 0.8});
    }
    for (int i = 0; i < 4; ++i) {
      const double from = 1.2 + 0.9 * i;
      map_.SeeAlong(second, on_planes ? 1 : -1, {from, 2.0}, {from + 0.8, 2.0});
    }
  }
  std::vector<RevisitOffset> Compare() {
    return CompareVisits(
        map_.rig(), map_.state(), CollectSightings(map_.rig(), map_.state(), 0), 0);
  }

  HandMadeMap map_;
  int wall_ = -1;
};

TEST_F(RevisitsTest, APlaceThatStandsWhereItStoodIsNotShifted) {
  SeeCorner(30, 0.004, true);
  const RevisitOffset offset = Compare()[30];
  EXPECT_GE(offset.num_segments, 60);
  EXPECT_LT(offset.translation_m, 0.006);
  EXPECT_FALSE(offset.is_shift());
}

TEST_F(RevisitsTest, FindsTheShiftOfWhatLiesOnNoPlane) {
  SeeCorner(30, 0.2, false);
  const RevisitOffset offset = Compare()[30];
  EXPECT_NEAR(offset.translation_m, 0.2, 0.02);
  EXPECT_LT(offset.near_share, 0.6);
  EXPECT_GT(offset.moved_share, 0.9);
  EXPECT_TRUE(offset.is_shift());
}

// A door that has been closed and stands ajar now: all that is off lies off one plane, turned.
TEST_F(RevisitsTest, ADoorThatHasMovedIsNoShift) {
  for (const double y : {-1.6, -1.2, -0.8, -0.4, 0.0, 0.4, 0.8}) {
    const double x = 5.15 + 0.05 * y;
    map_.SeeAlong(30, -1, {x, y}, {x + 0.0175, y + 0.35});
  }
  const RevisitOffset offset = Compare()[30];
  EXPECT_GT(offset.rotation_rad, 0.02);
  EXPECT_GT(offset.moved_share, offset.near_share + 0.1);
  EXPECT_LE(offset.num_surfaces, 1);
  EXPECT_FALSE(offset.is_shift());
}

TEST_F(RevisitsTest, SoonAfterwardsIsNoOtherVisit) {
  SeeCorner(5, 0.2, false);
  EXPECT_EQ(Compare()[5].num_segments, 0);
}

}  // namespace
}  // namespace plumbline
