#include "core/estimation/unknowns.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'000'000'000;
constexpr int64_t kKnot = 100'000'000;

class UnknownsTest : public testing::Test {
 protected:
  UnknownsTest() {
    trajectory_.ExtendTo(kStart + 5 * kKnot);
    landmarks_.push_back(MakeVerticalLandmark({1.0, 0.0, 0.0}, {3.0, 40.0, 1.0}));
    landmarks_.push_back(MakeHorizontalLandmark(1.0, {0.0, 0.0, -1.2}));
    landmarks_.back().id = 1;
  }

  Unknowns Make(bool planar) { return {planar, &trajectory_, &landmarks_, nullptr}; }

  Trajectory trajectory_{kStart, kKnot, Rigid3d()};
  std::deque<Landmark> landmarks_;
};

TEST_F(UnknownsTest, HaveWhatTermsHaveUnlessItIsHeld) {
  Unknowns unknowns = Make(false);
  unknowns.HoldLandmarks();
  unknowns.HoldControlPointsBefore(2);
  for (int i = 0; i < 4; ++i) {
    unknowns.Register(PositionBlock(i));
    unknowns.Register(RotationBlock(i));
  }
  unknowns.Register(LandmarkBlock(0));
  const BlockLayout layout = unknowns.Layout();
  EXPECT_EQ(layout.blocks.size(), 4u);
  EXPECT_EQ(layout.size(), 2 * 6);
  for (const BlockId& block : layout.blocks) EXPECT_GE(block.index, 2);
}

TEST_F(UnknownsTest, APlanarPoseIsHeldInHeightAndTilt) {
  Unknowns unknowns = Make(true);
  unknowns.Register(RotationBlock(0));
  unknowns.Register(PositionBlock(0));
  const BlockLayout layout = unknowns.Layout();
  EXPECT_EQ(layout.size(), 1 + 3);
  EXPECT_EQ(layout.FreeColumns().size(), 3u);
  unknowns.Move(layout, Eigen::Vector3d(0.1, 2.0, -1.0));
  EXPECT_NEAR(trajectory_.control_point(0).rotation[2], std::sin(0.05), 1e-12);
  EXPECT_EQ(trajectory_.control_point(0).position[0], 2.0);
  EXPECT_EQ(trajectory_.control_point(0).position[2], 0.0);
}

TEST_F(UnknownsTest, AHeldHeadingStaysAndValuesComeBack) {
  landmarks_[0].heading_fixed = true;
  Unknowns unknowns = Make(false);
  unknowns.Register(LandmarkBlock(0));
  unknowns.Register(LandmarkBlock(1));
  const BlockLayout layout = unknowns.Layout();
  EXPECT_EQ(layout.size(), 2 + 1);
  const std::deque<Landmark> before = landmarks_;
  const Unknowns::Values values = unknowns.ValuesOf(layout);
  unknowns.Move(layout, Eigen::Vector2d(0.5, 0.25));
  EXPECT_EQ(landmarks_[0].parameters[0], before[0].parameters[0]);
  EXPECT_NEAR(landmarks_[0].parameters[1], before[0].parameters[1] + 0.5, 1e-12);
  EXPECT_NEAR(landmarks_[1].parameters[0], before[1].parameters[0] + 0.25, 1e-12);
  unknowns.SetValues(layout, values);
  EXPECT_EQ(landmarks_[0].parameters, before[0].parameters);
  EXPECT_EQ(landmarks_[1].parameters, before[1].parameters);
}

// A wall that was seen far from the origin turns about where it was seen.
TEST_F(UnknownsTest, AWallTurnsAboutWhereItWasSeen) {
  landmarks_[0].extent.AddSegment({3.0, 39.0, 1.0}, {3.0, 41.0, 1.0});
  Unknowns unknowns = Make(false);
  unknowns.Register(LandmarkBlock(0));
  const double turn = 0.02;
  // To first order the turn about the wall's middle moves the distance by this.
  const double shift = 40.0 * turn;
  unknowns.Move(unknowns.Layout(), Eigen::Vector2d(turn, shift));
  EXPECT_NEAR(landmarks_[0].SignedDistance({3.0, 40.0, 1.0}), 0.0, 1e-9);
}

}  // namespace
}  // namespace plumbline
