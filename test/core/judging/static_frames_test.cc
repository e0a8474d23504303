#include "core/judging/static_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

// A frame that is turned by 90 degrees to the left in its parent.
Transform TurnedLeft(const std::string& parent,
                     const std::string& child,
                     const std::array<double, 3>& translation) {
  return {parent, child, translation, {0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5)}};
}
Transform Shifted(const std::string& parent,
                  const std::string& child,
                  const std::array<double, 3>& translation) {
  return {parent, child, translation, {0.0, 0.0, 0.0, 1.0}};
}

TEST(StaticFramesTest, TransformsAreChainedUpToBaseLink) {
  const StaticFrames frames =
      FindStaticFrames({Shifted("base_footprint", "base_link", {0, 0, 1}),
                        TurnedLeft("base_link", "mast", {1, 0, 0}),
                        Shifted("/mast", "/laser", {2, 0, 0})},
                       {"laser"});
  EXPECT_EQ(frames.body, "base_link");
  const Eigen::Vector3d expected(1.0, 2.0, 0.0);
  EXPECT_LT((frames.body_from_frame.at("laser").translation - expected).norm(), 1e-12);
}

TEST(StaticFramesTest, TheFrameThatCarriesAllIsTheBody) {
  const StaticFrames frames = FindStaticFrames(
      {Shifted("rig", "left", {0, 1, 0}), Shifted("rig", "right", {0, -1, 0})},
      {"left", "right", "unknown"});
  EXPECT_EQ(frames.body, "rig");
  EXPECT_THAT(frames.body_from_frame, SizeIs(2));
}

TEST(StaticFramesTest, FramesWithoutACommonOneHaveNoBody) {
  const StaticFrames frames = FindStaticFrames(
      {Shifted("a", "left", {0, 1, 0}), Shifted("b", "right", {0, -1, 0})}, {"left", "right"});
  EXPECT_EQ(frames.body, "");
  EXPECT_THAT(frames.body_from_frame, IsEmpty());
}

TEST(StaticFramesTest, RingsAndRotationsThatAreNoneAreNoFault) {
  Transform none = Shifted("base_link", "laser", {0, 0, 0});
  none.rotation = {0.0, 0.0, 0.0, 0.0};
  EXPECT_EQ(FindStaticFrames({none}, {"laser"}).body, "");
  const StaticFrames ring =
      FindStaticFrames({Shifted("a", "b", {1, 0, 0}), Shifted("b", "a", {1, 0, 0})}, {"a"});
  EXPECT_THAT(ring.body_from_frame, SizeIs(1));
}

}  // namespace
}  // namespace plumbline
