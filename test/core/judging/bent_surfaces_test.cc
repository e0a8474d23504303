#include "core/judging/bent_surfaces.h"

#include <gtest/gtest.h>

#include "core/map/observation.h"
#include "core/segmentation/segmentation.h"

namespace plumbline {
namespace {

constexpr double kHalfLength = 15.0;  // m, of floor and ceiling

// A rig at rest whose upright scanner sees a floor 1.5 m below and a ceiling 1.5 m above, over
// three strips side by side. Ahead of the rig they lie off their planes by these.
BentSurfaces Find(double floor_off_m, double ceiling_off_m) {
  Rig rig;
  rig.scanners.resize(1);
  Scanner& scanner = rig.scanners[0];
  scanner.range_noise_m = 0.01;
  scanner.body_from_scanner.rotation = Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX());
  MapState state{Trajectory(0, 50'000'000, Rigid3d()), {}, {}};
  state.trajectory.ExtendTo(2'000'000'000);
  for (const double height : {-1.5, 1.5}) {
    Landmark landmark =
        MakeHorizontalLandmark(height < 0.0 ? 1.0 : -1.0, Eigen::Vector3d(0.0, 0.0, height));
    landmark.extent.AddSegment({-kHalfLength, -1.0, height}, {kHalfLength, 1.0, height});
    state.landmarks.push_back(landmark);
  }
  // 1 m pieces of both, each seen from above or below it.
  for (int scan = 0; scan < 40; ++scan) {
    for (int landmark = 0; landmark < 2; ++landmark) {
      for (double x = -kHalfLength; x < kHalfLength; x += 1.5) {
        const double off = x > 8.0 ? (landmark == 0 ? floor_off_m : ceiling_off_m) : 0.0;
        const double height = (landmark == 0 ? -1.5 : 1.5) + off;
        ScanLine line;
        line.stamp_ns = 1'000'000'000;
        line.angle_min = std::atan2(height, x + 0.25);
        const double end = std::atan2(height, x + 1.25);
        line.angle_increment = (end - line.angle_min) / 20.0;
        for (int i = 0; i <= 20; ++i) {
          line.ranges.push_back(static_cast<float>(height / std::sin(line.BeamAngle(i))));
        }
        for (const Segment& found : SegmentScanLine(line, scanner, {}, {})) {
          state.observations.push_back(MakeObservation(line, scanner, found, false));
          state.observations.back().landmark_id = landmark;
        }
      }
    }
  }
  return FindBentSurfaces(rig, state, 0);
}

TEST(BentSurfaces, TurnedRigSeesFloorAndCeilingBend) {
  const BentSurfaces bent = Find(0.02, 0.02);
  ASSERT_EQ(bent.surfaces.size(), 2u);
  EXPECT_GT(bent.surfaces[0].num_off, 2);
  EXPECT_GT(bent.surfaces[1].num_off, 2);
  EXPECT_NEAR(bent.surfaces[0].largest_m, 0.02, 0.002);
  ASSERT_EQ(bent.seconds.size(), 2u);
  EXPECT_FALSE(bent.seconds[0]);
  EXPECT_TRUE(bent.seconds[1]) << "when the bent places were seen";
}

TEST(BentSurfaces, WhatBendsAloneIsNoRamp) {
  const BentSurfaces bent = Find(0.02, 0.0);
  EXPECT_GT(bent.surfaces[0].num_off, 2);
  EXPECT_EQ(bent.surfaces[1].num_off, 0);
  EXPECT_TRUE(bent.seconds.empty());
}

TEST(BentSurfaces, FlatOnesAreNotBent) {
  const BentSurfaces bent = Find(0.0, 0.0);
  ASSERT_EQ(bent.surfaces.size(), 2u);
  EXPECT_GE(bent.surfaces[0].num_tiles, 12);
  EXPECT_TRUE(bent.seconds.empty());
}

}  // namespace
}  // namespace plumbline
