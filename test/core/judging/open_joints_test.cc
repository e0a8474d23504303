#include "core/judging/open_joints.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "test/core/judging/hand_made_map.h"

namespace plumbline {
namespace {

// A rig at the origin sees a wall, then for two seconds a round wall about itself alone, then
// a wall again.
class OpenJointsTest : public testing::Test {
 protected:
  OpenJointsTest() {
    before_ = map_.AddWall(4.0, -2.0, 2.0);
    after_ = map_.AddWall(4.0, -2.0, 2.0);
    Landmark arc = MakeCylinderLandmark({-1.0, 0.0, 0.0}, -0.25, {4.0, 0.0, 0.0});
    arc.id = static_cast<int>(map_.state().landmarks.size());
    arc.extent.AddSegment({4.0, -1.0, 0.0}, {4.0, 1.0, 0.0});
    arc.num_segments = 1;
    map_.state().landmarks.push_back(arc);
    arc_ = arc.id;
  }

  void See(int second, int id) {
    map_.SeeAlong(second, id, {4.0, -1.0}, {4.0, 1.0});
    map_.SeeAlong(second, id, {-1.0, 4.0}, {1.0, 4.0});
  }

  std::vector<bool> Find() {
    auto& observations = map_.state().observations;
    std::stable_sort(
        observations.begin(), observations.end(), [](const auto& a, const auto& b) {
          return a.middle_time_ns() < b.middle_time_ns();
        });
    return FindOpenJoints(map_.rig(), map_.state(), 0);
  }

  HandMadeMap map_;
  int before_ = 0;
  int after_ = 0;
  int arc_ = 0;
};

TEST_F(OpenJointsTest, ARoundWallShowsNoHeading) {
  See(1, before_);
  for (const int second : {2, 3}) See(second, arc_);
  See(4, after_);
  const std::vector<bool> is_open = Find();
  ASSERT_GE(is_open.size(), 3u);
  EXPECT_TRUE(is_open[2]);
  EXPECT_EQ(std::count(is_open.begin(), is_open.end(), true), 1);
}

TEST_F(OpenJointsTest, AWallThatIsSeenAgainJoinsBothParts) {
  See(1, before_);
  for (const int second : {2, 3}) See(second, arc_);
  See(4, before_);
  const std::vector<bool> is_open = Find();
  EXPECT_EQ(std::count(is_open.begin(), is_open.end(), true), 0);
}

TEST_F(OpenJointsTest, APartBetweenTwoIsAskedForItself) {
  See(1, before_);
  See(2, arc_);
  See(3, after_);
  See(4, arc_);
  See(5, before_);
  const std::vector<bool> is_open = Find();
  ASSERT_GE(is_open.size(), 5u);
  EXPECT_TRUE(is_open[2]);
  EXPECT_TRUE(is_open[4]);
}

TEST_F(OpenJointsTest, AWallBesideTheRoundOneShowsTheHeading) {
  See(1, before_);
  for (const int second : {2, 3}) {
    See(second, arc_);
    See(second, after_);
  }
  See(4, after_);
  const std::vector<bool> is_open = Find();
  EXPECT_EQ(std::count(is_open.begin(), is_open.end(), true), 0);
}

}  // namespace
}  // namespace plumbline
