#include "core/registration/part_matching.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

namespace plumbline {
namespace {

using Eigen::Vector2d;
using ::testing::HasSubstr;

// The inner side of a room that is given by its corners, counterclockwise; beams from its
// middle.
PartView Room(const std::vector<Vector2d>& corners, const Vector2d& middle) {
  PartView view;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vector2d way = corners[(i + 1) % corners.size()] - corners[i];
    const Vector2d along = way.normalized();
    for (double at = 0.1; at < way.norm(); at += 0.2) {
      view.spots.push_back({corners[i] + at * along, Vector2d(-along.y(), along.x())});
    }
  }
  for (size_t i = 0; i < view.spots.size(); i += 5) {
    if (view.spots[i].normal.dot(middle - view.spots[i].position) > 0.0) {
      view.beams.push_back({middle, view.spots[i].position});
    }
  }
  return view;
}

// An odd room of eight walls, from whose middle all are seen.
PartView OddRoom(const Vector2d& at) {
  return Room({at + Vector2d(0.0, 0.0),
               at + Vector2d(7.0, 0.0),
               at + Vector2d(7.0, 3.1),
               at + Vector2d(5.6, 3.1),
               at + Vector2d(5.6, 5.2),
               at + Vector2d(1.3, 5.2),
               at + Vector2d(1.3, 4.0),
               at + Vector2d(0.0, 4.0)},
              at + Vector2d(3.0, 2.0));
}

// Takes a stretch of the odd room's wall at x = 7 away.
void RemoveEastWall(double from_y, double to_y, PartView* view) {
  const auto is_there = [&](const WallSpot& spot) {
    return spot.position.x() > 6.9 && spot.position.y() > from_y && spot.position.y() < to_y;
  };
  view->spots.erase(std::remove_if(view->spots.begin(), view->spots.end(), is_there),
                    view->spots.end());
}

PartView Rectangle(const Vector2d& at, double x, double y) {
  return Room({at, at + Vector2d(x, 0.0), at + Vector2d(x, y), at + Vector2d(0.0, y)},
              at + Vector2d(x, y) / 2.0);
}

PartView Together(PartView a, const PartView& b) {
  a.spots.insert(a.spots.end(), b.spots.begin(), b.spots.end());
  a.beams.insert(a.beams.end(), b.beams.begin(), b.beams.end());
  return a;
}

// The part in a frame of its own, in which its spots lie at other places along the walls, with
// 5 mm of noise.
PartView InFrame(const PartView& view, double yaw, const Vector2d& translation) {
  std::mt19937 random(21);
  std::normal_distribution<double> noise(0.0, 0.005);
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(-yaw).toRotationMatrix();
  PartView moved;
  for (const WallSpot& spot : view.spots) {
    const Vector2d along(-spot.normal.y(), spot.normal.x());
    const Vector2d p = spot.position + 0.07 * along + noise(random) * spot.normal;
    moved.spots.push_back({turn * (p - translation), turn * spot.normal});
  }
  for (const FreeBeam& beam : view.beams) {
    moved.beams.push_back({turn * (beam.from - translation), turn * (beam.to - translation)});
  }
  return moved;
}

TEST(MatchPartsTest, FindsThePoseWithoutAnInitialOne) {
  const PartView a = Together(OddRoom({0.0, 0.0}), Rectangle({8.0, 0.0}, 4.0, 6.0));
  for (const double yaw : {0.0, 0.6, 1.7, 3.0, -2.2}) {
    const Vector2d translation(12.0, -7.0);
    const PartMatch match =
        MatchParts(a, InFrame(OddRoom({0.0, 0.0}), yaw, translation), PartMatchingOptions());
    ASSERT_TRUE(match.pose) << yaw << ": " << match.reason;
    EXPECT_GT(std::cos(match.pose->a_from_b.heading - yaw), std::cos(0.003)) << yaw;
    // The parts' origins are 14 m apart: what 0.003 rad make there.
    EXPECT_LT((match.pose->a_from_b.position - translation).norm(), 0.045) << yaw;
    EXPECT_GT(match.pose->length_m, 20.0);
  }
}

TEST(MatchPartsTest, RoomsThatLookAlikeAreRefused) {
  const PartView a = Together(OddRoom({0.0, 0.0}), OddRoom({12.0, 0.0}));
  const PartMatch match =
      MatchParts(a, InFrame(OddRoom({0.0, 0.0}), 0.6, {3.0, 4.0}), PartMatchingOptions());
  EXPECT_FALSE(match.pose);
  EXPECT_THAT(match.reason, HasSubstr("look alike"));
}

TEST(MatchPartsTest, ARectangularRoomIsItsOwnLookAlike) {
  const PartMatch match = MatchParts(Rectangle({0.0, 0.0}, 4.0, 6.0),
                                     InFrame(Rectangle({0.0, 0.0}, 4.0, 6.0), 0.6, {3.0, 4.0}),
                                     PartMatchingOptions());
  EXPECT_FALSE(match.pose);
}

TEST(MatchPartsTest, TooLittleOverlapIsRefused) {
  PartView a = OddRoom({0.0, 0.0});
  PartView b = a;
  b.spots.resize(30);  // 6 m of one wall
  b.beams.clear();
  const PartMatch match = MatchParts(a, InFrame(b, 0.6, {3.0, 4.0}), PartMatchingOptions());
  EXPECT_FALSE(match.pose);
  EXPECT_THAT(match.reason, HasSubstr("too little"));
}

TEST(MatchPartsTest, ACorridorLeavesADirectionOpen) {
  PartView a;
  for (double x = 0.0; x < 20.0; x += 0.2) {
    a.spots.push_back({Vector2d(x, 0.0), Vector2d(0.0, 1.0)});
    a.spots.push_back({Vector2d(x, 2.0), Vector2d(0.0, -1.0)});
  }
  EXPECT_FALSE(MatchParts(a, InFrame(a, 0.6, {3.0, 4.0}), PartMatchingOptions()).pose);
}

TEST(MatchPartsTest, BeamsThroughWallsRefuteAPose) {
  PartView a = OddRoom({0.0, 0.0});
  PartView b = a;
  // Part b saw through where part a has a wall.
  RemoveEastWall(0.0, 3.1, &b);
  b.beams.clear();
  for (double y = 0.5; y < 3.0; y += 0.2)
    b.beams.push_back({Vector2d(3.0, y), Vector2d(9.0, y)});
  a.beams.clear();
  EXPECT_FALSE(MatchParts(a, InFrame(b, 0.6, {3.0, 4.0}), PartMatchingOptions()).pose);
}

// Of the beams along a wall none passes through it.
TEST(MatchPartsTest, BeamsAlongAWallRefuteNothing) {
  PartView a = OddRoom({0.0, 0.0});
  for (double x = 0.5; x < 6.5; x += 0.05) {
    a.beams.push_back({Vector2d(0.4, 0.05), Vector2d(x, 0.01)});
    a.beams.push_back({Vector2d(0.4, 0.5), Vector2d(x, 0.0)});
  }
  EXPECT_TRUE(MatchParts(a, InFrame(a, 0.6, {3.0, 4.0}), PartMatchingOptions()).pose);
}

// A segment that leads on across a door makes a wall of it, through which other beams of the
// same part pass.
TEST(MatchPartsTest, WallsThatTheirOwnBeamsPassThroughAreNone) {
  PartView a = OddRoom({0.0, 0.0});
  PartView b = a;
  RemoveEastWall(1.0, 2.0, &b);
  for (double y = 1.1; y < 1.9; y += 0.01) {
    for (PartView* view : {&a, &b}) {
      view->beams.push_back({Vector2d(3.0, y), Vector2d(9.0, y)});
    }
  }
  EXPECT_TRUE(MatchParts(a, InFrame(b, 0.6, {3.0, 4.0}), PartMatchingOptions()).pose);
}

TEST(MatchPartsTest, OnlyPossiblePosesCount) {
  const PartView a = OddRoom({0.0, 0.0});
  const PartView b = InFrame(a, 0.6, {3.0, 4.0});
  const auto match = [&](double max_shift_m) {
    return MatchParts(a, b, PartMatchingOptions(), [max_shift_m](const PlanarPose& pose) {
      return pose.position.norm() < max_shift_m;
    });
  };
  EXPECT_TRUE(match(10.0).pose);
  EXPECT_FALSE(match(1.0).pose);
  EXPECT_FALSE(match(1.0).reason.empty());
}

TEST(MatchPartsTest, APartWithoutWallsIsRefused) {
  EXPECT_FALSE(MatchParts(PartView(), OddRoom({0.0, 0.0}), PartMatchingOptions()).pose);
}

}  // namespace
}  // namespace plumbline
