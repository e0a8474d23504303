#include "core/association/range_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/map/observation.h"
#include "core/segmentation/segmentation.h"

namespace plumbline {
namespace {

constexpr double kStated = 0.03;  // m
constexpr double kNear = 0.01;    // m, of ranges below 4 m
constexpr double kFar = 0.02;     // m

// A scanner at rest before two walls, 3 and 6 m ahead: one scan line of each in turn.
MapState Look(const Rig& rig, int num_scans) {
  MapState state{Trajectory(0, 50'000'000, Rigid3d()), {}, {}};
  state.trajectory.ExtendTo(500'000'000);
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  for (const double distance : {3.0, 6.0}) {
    state.landmarks.push_back(
        MakeVerticalLandmark(-Eigen::Vector3d::UnitX(), {distance, 0.0, 0.0}));
  }
  for (int scan = 0; scan < num_scans; ++scan) {
    const int wall = scan % 2;
    ScanLine line;
    line.stamp_ns = 100'000'000;
    line.angle_min = -0.2;
    line.angle_increment = 0.004;
    for (int i = 0; i <= 100; ++i) {
      const double sigma = wall == 0 ? kNear : kFar;
      line.ranges.push_back(static_cast<float>(
          (wall == 0 ? 3.0 : 6.0) / std::cos(line.BeamAngle(i)) + sigma * noise(random)));
    }
    for (const Segment& found : SegmentScanLine(line, rig.scanners[0], {}, {})) {
      state.observations.push_back(MakeObservation(line, rig.scanners[0], found, false));
      state.observations.back().landmark_id = wall;
    }
  }
  return state;
}

TEST(RangeNoise, IsWhatTheBeamsScatterBy) {
  Rig rig;
  rig.scanners.emplace_back();
  rig.scanners[0].name = "only";
  rig.scanners[0].range_noise_m = kStated;
  const std::vector<ScannerNoise> noises = EstimateRangeNoise(rig, Look(rig, 40));
  ASSERT_EQ(noises.size(), 1u);
  EXPECT_EQ(noises[0].scanner, "only");
  EXPECT_EQ(noises[0].stated_m, kStated);
  ASSERT_TRUE(noises[0].noise_m.has_value());
  EXPECT_NEAR(*noises[0].noise_m, std::hypot(kNear, kFar) / std::sqrt(2.0), 0.001);
  ASSERT_EQ(noises[0].by_range.size(), 2u);
  EXPECT_EQ(noises[0].by_range[0].from, 2.0);
  EXPECT_EQ(noises[0].by_range[0].to, 4.0);
  EXPECT_NEAR(noises[0].by_range[0].noise_m, kNear, 0.001);
  EXPECT_NEAR(noises[0].by_range[1].noise_m, kFar, 0.002);
  ASSERT_EQ(noises[0].by_incidence.size(), 1u);
  EXPECT_EQ(noises[0].by_incidence[0].from, 0.0);
  EXPECT_EQ(noises[0].by_incidence[0].to, 15.0);
}

TEST(RangeNoise, FewBeamsSayNothing) {
  Rig rig;
  rig.scanners.resize(1);
  const std::vector<ScannerNoise> noises = EstimateRangeNoise(rig, Look(rig, 2));
  ASSERT_EQ(noises.size(), 1u);
  EXPECT_FALSE(noises[0].noise_m.has_value());
  EXPECT_TRUE(noises[0].by_range.empty());
}

}  // namespace
}  // namespace plumbline
