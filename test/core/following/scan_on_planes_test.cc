#include "core/following/scan_on_planes.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace plumbline {
namespace {

constexpr double kFlatness = 0.003;  // m

// A floor, two walls across each other and a column, each seen on 2 m, and segments on those
// that are named.
MapState StateWithSegmentsOn(std::initializer_list<int> ids) {
  MapState state{Trajectory(0, 125'000'000, Rigid3d()), {}, {}, 0, {}};
  state.landmarks = {MakeHorizontalLandmark(1.0, {0.0, 0.0, 0.0}),
                     MakeVerticalLandmark({1.0, 0.0, 0.0}, {-3.0, 0.0, 1.0}),
                     MakeVerticalLandmark({0.0, 1.0, 0.0}, {0.0, -3.0, 1.0}),
                     MakeCylinderLandmark({0.0, -1.0, 0.0}, 0.2, {0.0, 3.0, 1.0})};
  for (Landmark& landmark : state.landmarks) {
    const PlaneAxes axes = landmark.extent.axes();
    landmark.extent.AddSegment(axes.anchor, axes.ToWorld({2.0, 0.0}));
  }
  for (const int id : ids) {
    state.observations.emplace_back();
    state.observations.back().landmark_id = id;
    state.observations.back().sigma_offset_m = 0.004F;
  }
  return state;
}

TEST(ScanOnPlanesTest, FloorsAreNoNarrowWalls) {
  const MapState state = StateWithSegmentsOn({0, 1, 2, 3});
  EXPECT_FALSE(IsNarrowWall(state.landmarks[0], 3.0));
  EXPECT_TRUE(IsNarrowWall(state.landmarks[1], 3.0));
  EXPECT_FALSE(IsNarrowWall(state.landmarks[1], 1.0));
  EXPECT_EQ(OnNarrowPlanes(state, 0, 3, 3.0), (std::vector<int>{1, 2, 3}));
}

TEST(ScanOnPlanesTest, WallsOfTwoDirectionsHoldThePosition) {
  const auto leave_open = [](std::initializer_list<int> ids, double min_width_m) {
    const int last = static_cast<int>(ids.size()) - 1;
    return WallsLeaveOpen(StateWithSegmentsOn(ids), 0, last, min_width_m, kFlatness);
  };
  EXPECT_FALSE(leave_open({1, 2}, 1.0));
  EXPECT_FALSE(leave_open({1, 3}, 1.0));
  EXPECT_TRUE(leave_open({1, 2}, 3.0));
  EXPECT_TRUE(leave_open({0, 1, 0}, 1.0));
}

TEST(ScanOnPlanesTest, FloorsHoldTheHeight) {
  EXPECT_FALSE(HeightIsOpen(StateWithSegmentsOn({0}), 0, 0, kFlatness));
  EXPECT_TRUE(HeightIsOpen(StateWithSegmentsOn({1, 2, 3}), 0, 2, kFlatness));
}

}  // namespace
}  // namespace plumbline
