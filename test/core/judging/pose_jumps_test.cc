#include "core/judging/pose_jumps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "test/core/judging/hand_made_map.h"

namespace plumbline {
namespace {

MapState AsMap(Trajectory trajectory) { return {std::move(trajectory), {}, {}, 0, {}}; }

Trajectory WalkAlongX(double speed_m_s) {
  Trajectory trajectory(0, 125'000'000, Rigid3d());
  trajectory.ExtendTo(20'000'000'000);
  for (int i = 0; i < trajectory.num_control_points(); ++i) {
    trajectory.control_point(i).position[0] = 0.125 * speed_m_s * i;
  }
  return trajectory;
}

TEST(PoseJumpsTest, AWalkHasNone) {
  const std::vector<SecondOfMotion> motion = MotionOverTime(AsMap(WalkAlongX(1.0)), 0);
  ASSERT_GE(motion.size(), 20u);
  for (const double acceleration : motion[5].accelerations) {
    EXPECT_NEAR(acceleration, 0.0, 1e-9);
  }
  for (const bool is_jump : FindJumps(motion, {})) EXPECT_FALSE(is_jump);
}

TEST(PoseJumpsTest, FindsAShiftOfHalfAMetre) {
  Trajectory trajectory = WalkAlongX(1.0);
  const int half = trajectory.num_control_points() / 2;
  for (int i = half; i < trajectory.num_control_points(); ++i) {
    trajectory.control_point(i).position[1] += 0.5;
  }
  const std::vector<bool> jumps = FindJumps(MotionOverTime(AsMap(trajectory), 0), {});
  const int num_jumps = static_cast<int>(std::count(jumps.begin(), jumps.end(), true));
  EXPECT_GE(num_jumps, 1);
  EXPECT_LE(num_jumps, 2);
  const auto at = std::find(jumps.begin(), jumps.end(), true) - jumps.begin();
  EXPECT_NEAR(static_cast<double>(at), (half - 1) * 0.125, 1.5);
}

TEST(PoseJumpsTest, ARigThatShakesAllTheTimeDoesNotJump) {
  Trajectory trajectory = WalkAlongX(1.0);
  for (int i = 0; i < trajectory.num_control_points(); ++i) {
    trajectory.control_point(i).position[1] += i % 2 == 0 ? 0.1 : -0.1;
  }
  for (const bool is_jump : FindJumps(MotionOverTime(AsMap(trajectory), 0), {}))
    EXPECT_FALSE(is_jump);
}

// A slip of the height on a stair: hardly a jolt, but beams pass through the steps.
TEST(PoseJumpsTest, LessIsAJumpWhereBeamsPassThroughSurfaces) {
  std::vector<SecondOfMotion> motion(10, {{2.5, 1.0, 1.0, 1.0}});
  motion[5].accelerations[SecondOfMotion::kHorizontal] = 6.5;
  SharesOverTime passages(10, {2.0, 200.0});
  EXPECT_EQ(FindJumps(motion, passages), std::vector<bool>(10, false));
  passages[5].contradicted = 26.0;
  std::vector<bool> expected(10, false);
  expected[5] = true;
  EXPECT_EQ(FindJumps(motion, passages), expected);
  passages[5] = {3.0, 23.0};  // too few places to tell
  EXPECT_EQ(FindJumps(motion, passages), std::vector<bool>(10, false));
}

// A robot that hardly ever tilts, and for an instant does by a degree.
TEST(PoseJumpsTest, AreJudgedByTheKindOfMotion) {
  std::vector<SecondOfMotion> motion(20, {{2.0, 0.1, 8.0, 0.1}});
  motion[5].accelerations[SecondOfMotion::kYaw] = 13.0;
  EXPECT_EQ(FindJumps(motion, {}), std::vector<bool>(20, false));
  motion[7].accelerations[SecondOfMotion::kTilt] = 1.5;
  std::vector<bool> expected(20, false);
  expected[7] = true;
  EXPECT_EQ(FindJumps(motion, {}), expected);
}

// A rig at rest that slips after 10 s. All along it sees a wall across the x axis, and may see
// somebody's back instead.
class UnsupportedJumpTest : public testing::Test {
 protected:
  UnsupportedJumpTest()
      : wall_(map_.AddWall(5.0, -2.0, 2.0)), back_(map_.AddWall(3.0, -0.3, 0.3)) {}

  void SeeTheWall(int first_second, int end_second) {
    for (int s = first_second; s < end_second; ++s) map_.See(s, wall_, 5.0, -2.0, 2.0);
  }
  void SeeTheBack(int first_second, int end_second) {
    for (int s = first_second; s < end_second; ++s) map_.See(s, back_, 3.0, -0.3, 0.3);
  }
  void Slip(int axis, double by_m) {
    Trajectory& trajectory = map_.state().trajectory;
    constexpr int kFirst = 82;
    for (int i = kFirst; i < trajectory.num_control_points(); ++i) {
      trajectory.control_point(i).position[axis] += by_m;
    }
  }
  // usual_m_s2: the horizontal acceleration of every tenth second.
  std::vector<int> Jumps(double usual_m_s2 = 0.0) {
    std::vector<SecondOfMotion> motion(20);
    for (size_t s = 0; s < motion.size(); s += 5) {
      motion[s].accelerations[SecondOfMotion::kHorizontal] = usual_m_s2;
    }
    const std::vector<bool> is_jump =
        FindUnsupportedJumps(map_.rig(), map_.state(), motion, 0);
    std::vector<int> seconds;
    for (size_t s = 0; s < is_jump.size(); ++s) {
      if (is_jump[s]) seconds.push_back(static_cast<int>(s));
    }
    return seconds;
  }

  HandMadeMap map_;
  int wall_;
  int back_;
};

TEST_F(UnsupportedJumpTest, IsNoneWhereTheWallShowsIt) {
  SeeTheWall(0, 20);
  Slip(0, 0.1);
  EXPECT_EQ(Jumps(), std::vector<int>());
}

TEST_F(UnsupportedJumpTest, IsOneWhereOnlyANarrowPlaneDoes) {
  SeeTheWall(0, 9);
  SeeTheBack(9, 12);
  SeeTheWall(12, 20);
  EXPECT_EQ(Jumps(), std::vector<int>());  // the rig is still at rest
  Slip(0, 0.1);
  EXPECT_EQ(Jumps(), std::vector<int>({10}));
}

// A rig that takes turns hard does so in doorways, where little shows it.
TEST_F(UnsupportedJumpTest, IsNoneWhereTheRigOftenMovesSo) {
  SeeTheWall(0, 9);
  SeeTheBack(9, 12);
  SeeTheWall(12, 20);
  Slip(0, 0.1);
  EXPECT_EQ(Jumps(3.0), std::vector<int>({10}));
  EXPECT_EQ(Jumps(20.0), std::vector<int>());
}

// The wall says nothing of the height; a person on stairs moves harder than along a corridor.
TEST_F(UnsupportedJumpTest, IsJudgedByItsOwnDirection) {
  SeeTheWall(0, 20);
  Slip(2, 0.05);
  EXPECT_EQ(Jumps(), std::vector<int>());
  Slip(2, 0.1);
  EXPECT_EQ(Jumps(), std::vector<int>({10}));
}

// Ten seconds of motion and of support, eight intervals a second; at 5 s something happens.
class GlitchTest : public testing::Test {
 protected:
  GlitchTest() : motion_(10, {{1.5, 1.0, 1.0, 1.0}}), support_(80, {100.0, 1000.0}) {}

  std::vector<SecondOfMotion> motion_;
  SharesOverTime support_;
};

TEST_F(GlitchTest, IsAnInstantOffThePlanesWithAJerk) {
  motion_[5].accelerations[SecondOfMotion::kHorizontal] = 4.0;
  support_[42].contradicted = 400.0;
  std::vector<bool> expected(10, false);
  expected[5] = true;
  EXPECT_EQ(FindGlitches(motion_, support_), expected);
}

TEST_F(GlitchTest, NeitherAloneIsOne) {
  support_[42].contradicted = 400.0;
  EXPECT_EQ(FindGlitches(motion_, support_), std::vector<bool>(10, false));
  motion_[2].accelerations[SecondOfMotion::kHorizontal] = 4.0;
  EXPECT_EQ(FindGlitches(motion_, support_), std::vector<bool>(10, false));
}

}  // namespace
}  // namespace plumbline
