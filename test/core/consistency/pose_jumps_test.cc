#include "core/consistency/pose_jumps.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace plumbline {
namespace {

Trajectory WalkAlongX(double speed_m_s) {
  Trajectory trajectory(0, 125'000'000, Rigid3d());
  trajectory.ExtendTo(20'000'000'000);
  for (int i = 0; i < trajectory.num_control_points(); ++i) {
    trajectory.control_point(i).position[0] = 0.125 * speed_m_s * i;
  }
  return trajectory;
}

TEST(PoseJumpsTest, AWalkHasNone) {
  const std::vector<SecondOfMotion> motion = MotionOverTime(WalkAlongX(1.0), 0);
  ASSERT_GE(motion.size(), 20u);
  EXPECT_NEAR(motion[5].speed_m_s, 1.0, 1e-9);
  EXPECT_NEAR(motion[5].acceleration_m_s2, 0.0, 1e-9);
  for (const bool is_jump : FindJumps(motion, {})) EXPECT_FALSE(is_jump);
}

TEST(PoseJumpsTest, FindsAShiftOfHalfAMetre) {
  Trajectory trajectory = WalkAlongX(1.0);
  const int half = trajectory.num_control_points() / 2;
  for (int i = half; i < trajectory.num_control_points(); ++i) {
    trajectory.control_point(i).position[1] += 0.5;
  }
  const std::vector<bool> jumps = FindJumps(MotionOverTime(trajectory, 0), {});
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
  for (const bool is_jump : FindJumps(MotionOverTime(trajectory, 0), {}))
    EXPECT_FALSE(is_jump);
}

// A slip of the height on a stair: hardly a jolt, but beams pass through the steps.
TEST(PoseJumpsTest, LessIsAJumpWhereBeamsPassThroughSurfaces) {
  std::vector<SecondOfMotion> motion(10, {2.5, 1.0, 1.0});
  motion[5].acceleration_m_s2 = 7.5;
  SharesOverTime passages(10, {2.0, 200.0});
  EXPECT_EQ(FindJumps(motion, passages), std::vector<bool>(10, false));
  passages[5].contradicted = 26.0;
  std::vector<bool> expected(10, false);
  expected[5] = true;
  EXPECT_EQ(FindJumps(motion, passages), expected);
  passages[5] = {3.0, 23.0};  // too few places to tell
  EXPECT_EQ(FindJumps(motion, passages), std::vector<bool>(10, false));
}

TEST(PoseJumpsTest, TheHeightJumpsOnlyWhereItHangsOnTreads) {
  Trajectory trajectory = WalkAlongX(1.0);
  const int half = trajectory.num_control_points() / 2;
  for (int i = half; i < trajectory.num_control_points(); ++i) {
    trajectory.control_point(i).position[2] -= 0.18;
  }
  const std::vector<SecondOfMotion> motion = MotionOverTime(trajectory, 0);
  std::vector<bool> hangs(motion.size(), false);
  for (const bool is_jump : FindHeightJumps(motion, hangs)) EXPECT_FALSE(is_jump);
  const auto second = static_cast<size_t>((half - 1) * 0.125);
  hangs[second] = true;
  const std::vector<bool> jumps = FindHeightJumps(motion, hangs);
  EXPECT_TRUE(jumps[second]);
  EXPECT_LE(std::count(jumps.begin(), jumps.end(), true), 2);
}

TEST(PoseJumpsTest, TheHeightHangsOnTreadsWhereNoFloorOrCeilingIsSeen) {
  MapState state{WalkAlongX(1.0), {}, {}, 0, {}};
  const auto add_plane = [&](double side_m) {
    Landmark plane = MakeHorizontalLandmark(1.0, Eigen::Vector3d::Zero());
    plane.id = static_cast<int>(state.landmarks.size());
    plane.extent = plane.EmptyExtent();
    plane.extent.AddSegment({0.0, 0.0, 0.0}, {1.5, side_m, 0.0});
    state.landmarks.push_back(plane);
  };
  add_plane(2.0);   // a floor
  add_plane(0.28);  // a tread
  for (int i = 0; i < 16; ++i) {
    Observation observation;
    observation.landmark_id = i == 12 ? 1 : 0;
    observation.start_ns = observation.end_ns = i * 125'000'000;
    state.observations.push_back(observation);
  }
  const std::vector<bool> expected = {false, true};
  EXPECT_EQ(HeightHangsOnTreads(state, 0), expected);
}

// Ten seconds of motion and of support, eight intervals a second; at 5 s something happens.
class GlitchTest : public testing::Test {
 protected:
  GlitchTest() : motion_(10, {1.0, 1.0, 1.0}), support_(80, {100.0, 1000.0}) {}

  std::vector<SecondOfMotion> motion_;
  SharesOverTime support_;
};

TEST_F(GlitchTest, IsAnInstantOffThePlanesWithAJerk) {
  motion_[5].acceleration_m_s2 = 2.0;
  support_[42].contradicted = 400.0;
  std::vector<bool> expected(10, false);
  expected[5] = true;
  EXPECT_EQ(FindGlitches(motion_, support_), expected);
}

TEST_F(GlitchTest, NeitherAloneIsOne) {
  support_[42].contradicted = 400.0;
  EXPECT_EQ(FindGlitches(motion_, support_), std::vector<bool>(10, false));
  motion_[2].acceleration_m_s2 = 2.0;
  EXPECT_EQ(FindGlitches(motion_, support_), std::vector<bool>(10, false));
}

}  // namespace
}  // namespace plumbline
