#include "core/following/scan_on_planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>

namespace plumbline {
namespace {

constexpr double kFlatness = 0.003;  // m

Rig OneScanner() {
  Rig rig;
  rig.scanners.resize(1);
  return rig;
}

// A segment from one point to another, scanner frame.
Observation SegmentOf(int id, const Eigen::Vector2f& first, const Eigen::Vector2f& last) {
  Observation observation;
  SegmentMeasurement measurement;
  measurement.node_times_ns = {50'000'000, 55'000'000, 60'000'000};
  observation.end_ns = 10'000'000;
  observation.first_point = first;
  observation.last_point = last;
  observation.measurement =
      PackedSegment(measurement, {0.5F * (first + last), (last - first).normalized()});
  observation.landmark_id = id;
  observation.sigma_offset_m = 0.004F;
  return observation;
}

// A level scanner in the origin; a floor, two walls across each other, a column and a round
// wall about the scanner, each seen on 2 m, and segments on those that are named.
MapState StateWithSegmentsOn(std::initializer_list<int> ids) {
  MapState state{Trajectory(0, 125'000'000, Rigid3d()), {}, {}, 0, {}};
  state.trajectory.ExtendTo(500'000'000);
  state.landmarks = {MakeHorizontalLandmark(1.0, {0.0, 0.0, 0.0}),
                     MakeVerticalLandmark({1.0, 0.0, 0.0}, {-3.0, 0.0, 1.0}),
                     MakeVerticalLandmark({0.0, 1.0, 0.0}, {0.0, -3.0, 1.0}),
                     MakeCylinderLandmark({0.0, -1.0, 0.0}, 0.2, {0.0, 3.0, 1.0}),
                     MakeCylinderLandmark({-1.0, 0.0, 0.0}, -0.2, {5.0, 0.0, 1.0})};
  for (Landmark& landmark : state.landmarks) {
    const PlaneAxes axes = landmark.extent.axes();
    landmark.extent.AddSegment(axes.anchor, axes.ToWorld({2.0, 0.0}));
  }
  for (const int id : ids) {
    if (id == 4) {  // a quarter of the round wall
      state.observations.push_back(SegmentOf(id, {4.9F, -1.0F}, {4.9F, 1.0F}));
      state.observations.push_back(SegmentOf(id, {-1.0F, 4.9F}, {1.0F, 4.9F}));
    } else if (id == 1) {
      state.observations.push_back(SegmentOf(id, {-3.0F, -1.0F}, {-3.0F, 1.0F}));
    } else {
      const float y = id == 3 ? 3.0F : -3.0F;
      state.observations.push_back(SegmentOf(id, {-1.0F, y}, {1.0F, y}));
    }
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

TEST(ScanOnPlanesTest, WallsOfTwoDirectionsHoldPositionAndHeading) {
  const auto leave_open = [](std::initializer_list<int> ids, double min_width_m) {
    const MapState state = StateWithSegmentsOn(ids);
    const int last = static_cast<int>(state.observations.size()) - 1;
    const bool is_open =
        WallsLeavePoseOpen(OneScanner(), state, 0, last, min_width_m, kFlatness);
    if (std::find(ids.begin(), ids.end(), 4) == ids.end()) {
      EXPECT_EQ(WallsLeaveOpen(state, 0, last, min_width_m, kFlatness), is_open);
    }
    return is_open;
  };
  EXPECT_FALSE(leave_open({1, 2}, 1.0));
  EXPECT_FALSE(leave_open({1, 3}, 1.0));
  EXPECT_TRUE(leave_open({1, 2}, 3.0));
  EXPECT_TRUE(leave_open({0, 1, 0}, 1.0));
  EXPECT_TRUE(leave_open({4}, 1.0)) << "the rig may turn about the axis";
  EXPECT_FALSE(leave_open({4, 1}, 1.0));
}

TEST(ScanOnPlanesTest, FloorsHoldTheHeight) {
  EXPECT_FALSE(HeightIsOpen(StateWithSegmentsOn({0}), 0, 0, kFlatness));
  EXPECT_TRUE(HeightIsOpen(StateWithSegmentsOn({1, 2, 3}), 0, 2, kFlatness));
}

}  // namespace
}  // namespace plumbline
