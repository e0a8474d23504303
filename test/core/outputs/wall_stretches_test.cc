#include "core/outputs/wall_stretches.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace plumbline {
namespace {

using ::testing::SizeIs;

// A straight face with 10 m of columns that nobody has seen; its parameter is y where its
// normal is the x axis, and -x where that is the y axis.
WallFace Face(double nx, double ny, double distance, double start_m = 0.0) {
  PlanePatch plane;
  plane.normal = {nx, ny, 0.0};
  plane.distance = distance;
  WallFace face;
  face.curve = WallCurve(plane, 0.0);
  face.planes = {0};
  face.start_m = start_m;
  face.columns.resize(200);
  face.hit_ends.resize(200);
  face.pass_ends.resize(200);
  face.plane_hits.assign(1, std::vector<uint32_t>(200, 0));
  return face;
}

enum class Seen { kHit, kPassed, kPassedShortly, kWindow };

// Beams every centimetre at all heights, or, of a window, through its upper part.
void See(double from, double to, Seen seen, WallFace* face) {
  for (double s = from + 0.005; s < to; s += 0.01) {
    const int at = face->ColumnOf(s);
    ASSERT_GE(at, 0);
    const auto column = static_cast<size_t>(at);
    for (size_t level = 0; level < WallColumn::kNumLevels; ++level) {
      const bool passed = seen == Seen::kPassed || seen == Seen::kPassedShortly ||
                          (seen == Seen::kWindow && level >= WallColumn::kNumLow);
      if (passed) {
        ++face->columns[column].passes[level];
        face->pass_ends[column].Extend(s);
        if (seen == Seen::kPassed) ++face->columns[column].deep_passes;
      } else {
        ++face->columns[column].hits[level];
        face->hit_ends[column].Extend(s);
      }
    }
  }
}

void AddLintel(double from, double to, WallFace* face) {
  for (int i = face->ColumnOf(from); i <= face->ColumnOf(to); ++i) {
    face->columns[static_cast<size_t>(i)].hits_above = 5;
  }
}

ColumnState StateAt(const WallFace& face, const Stretches& stretches, double s) {
  return stretches.states[static_cast<size_t>(face.ColumnOf(s))];
}

TEST(WallStretches, AGapThatBeamsPassIsADoor) {
  WallFace face = Face(1.0, 0.0, 0.0);
  See(1.0, 3.0, Seen::kHit, &face);
  See(3.0, 3.92, Seen::kPassed, &face);
  See(3.92, 6.0, Seen::kHit, &face);
  const Stretches stretches = FindStretches({face})[0];
  ASSERT_THAT(stretches.doors, SizeIs(1));
  EXPECT_NEAR(stretches.doors[0].from_m, 3.0, 0.0155);
  EXPECT_NEAR(stretches.doors[0].to_m, 3.92, 0.0155);
  EXPECT_FALSE(stretches.doors[0].has_lintel);
  EXPECT_GT(stretches.doors[0].stddev_m, 0.01);
  EXPECT_EQ(StateAt(face, stretches, 3.5), ColumnState::kDoor);
  EXPECT_EQ(StateAt(face, stretches, 2.0), ColumnState::kSolid);
  EXPECT_EQ(StateAt(face, stretches, 8.0), ColumnState::kUnseen);
}

TEST(WallStretches, WideGapsStayOpenAndSlitsAreBridged) {
  WallFace face = Face(1.0, 0.0, 0.0);
  See(1.0, 3.0, Seen::kHit, &face);
  See(3.0, 5.0, Seen::kPassed, &face);
  See(5.0, 6.0, Seen::kHit, &face);
  See(6.0, 6.4, Seen::kPassed, &face);
  See(6.4, 8.0, Seen::kHit, &face);
  const Stretches stretches = FindStretches({face})[0];
  EXPECT_THAT(stretches.doors, SizeIs(0));
  EXPECT_EQ(StateAt(face, stretches, 4.0), ColumnState::kOpen);
  EXPECT_EQ(StateAt(face, stretches, 6.2), ColumnState::kBridged);
}

TEST(WallStretches, WhatNoBeamPassedIsBridged) {
  WallFace face = Face(1.0, 0.0, 0.0);
  See(1.0, 3.0, Seen::kHit, &face);
  See(5.5, 8.0, Seen::kHit, &face);
  const Stretches stretches = FindStretches({face})[0];
  EXPECT_EQ(StateAt(face, stretches, 4.0), ColumnState::kBridged);
  EXPECT_THAT(stretches.doors, SizeIs(0));
}

TEST(WallStretches, ARecessIsBridged) {
  WallFace face = Face(1.0, 0.0, 0.0);
  See(1.0, 3.0, Seen::kHit, &face);
  See(3.0, 5.0, Seen::kPassedShortly, &face);
  See(5.0, 6.0, Seen::kHit, &face);
  EXPECT_EQ(StateAt(face, FindStretches({face})[0], 4.0), ColumnState::kBridged);
  // But not where a wall stands a little behind: there the room has a step.
  WallFace behind = Face(1.0, 0.0, -0.3);
  See(3.0, 5.0, Seen::kHit, &behind);
  EXPECT_EQ(StateAt(face, FindStretches({face, behind})[0], 4.0), ColumnState::kOpen);
}

TEST(WallStretches, AWideGapBelowALintelIsClosedUnlessTheRigWentThrough) {
  WallFace face = Face(1.0, 0.0, 0.0);
  See(1.0, 3.0, Seen::kHit, &face);
  See(3.0, 5.0, Seen::kPassed, &face);
  See(5.0, 6.0, Seen::kHit, &face);
  AddLintel(3.0, 5.0, &face);
  EXPECT_EQ(StateAt(face, FindStretches({face})[0], 4.0), ColumnState::kDoor);
  face.columns[static_cast<size_t>(face.ColumnOf(4.5))].rig_passed = true;
  EXPECT_EQ(StateAt(face, FindStretches({face})[0], 4.0), ColumnState::kOpen);
}

TEST(WallStretches, AWindowIsWall) {
  WallFace face = Face(1.0, 0.0, 0.0);
  See(1.0, 3.0, Seen::kHit, &face);
  See(3.0, 4.0, Seen::kWindow, &face);
  See(4.0, 6.0, Seen::kHit, &face);
  const Stretches stretches = FindStretches({face})[0];
  EXPECT_EQ(StateAt(face, stretches, 3.5), ColumnState::kSolid);
  EXPECT_TRUE(stretches.windows[static_cast<size_t>(face.ColumnOf(3.5))]);
  EXPECT_FALSE(stretches.windows[static_cast<size_t>(face.ColumnOf(2.0))]);
}

TEST(WallStretches, TheWidthOfACorridorIsNoDoor) {
  // The face ends at a corridor of 1.2 m and goes on behind it.
  WallFace face = Face(1.0, 0.0, 5.0);
  See(1.0, 3.0, Seen::kHit, &face);
  See(3.0, 4.2, Seen::kPassed, &face);
  See(4.2, 7.0, Seen::kHit, &face);
  WallFace low = Face(0.0, 1.0, 3.0, -10.0);  // the corridor's walls look at each other
  WallFace high = Face(0.0, -1.0, -4.2, 0.0);
  See(-9.0, -1.0, Seen::kHit, &low);
  See(1.0, 9.0, Seen::kHit, &high);
  std::vector<WallFace> faces = {face, low, high};
  EXPECT_THAT(FindStretches(faces)[0].doors, SizeIs(0));
  // But with a lintel above it is one.
  AddLintel(3.0, 4.2, &faces[0]);
  EXPECT_THAT(FindStretches(faces)[0].doors, SizeIs(1));
}

TEST(WallStretches, AGapBesideAPillarIsNoDoor) {
  WallFace face = Face(1.0, 0.0, 5.0);
  See(2.0, 2.4, Seen::kHit, &face);  // a pillar
  See(2.4, 3.4, Seen::kPassed, &face);
  WallFace wall = Face(0.0, -1.0, -3.4, 0.0);  // crosses at 3.4
  See(1.0, 9.0, Seen::kHit, &wall);
  const std::vector<WallFace> faces = {face, wall};
  EXPECT_THAT(FindStretches(faces)[0].doors, SizeIs(0));
}

TEST(WallStretches, FacesCrossWhereTheirLinesDo) {
  const std::vector<WallFace> faces = {
      Face(1.0, 0.0, 5.0), Face(0.0, -1.0, -3.4, 0.0), Face(-1.0, 0.0, -5.2, -10.0)};
  const std::vector<FaceCrossing> crossings = CrossingsOf(0, faces);
  ASSERT_THAT(crossings, SizeIs(1));  // the third one is parallel
  EXPECT_EQ(crossings[0].face, 1u);
  EXPECT_NEAR(crossings[0].s, 3.4, 1e-9);
  EXPECT_NEAR(crossings[0].other_s, 5.0, 1e-9);
}

}  // namespace
}  // namespace plumbline
