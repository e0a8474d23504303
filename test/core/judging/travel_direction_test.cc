#include "core/judging/travel_direction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geometry/angles.h"
#include "core/util/time.h"
#include "test/testing/six_walls.h"

namespace plumbline {
namespace {

// The sample of a level scanner, turned by yaw on a rig that drives through the room along a
// heading, at a speed, looking ahead.
std::vector<SampledLine> Drive(double yaw, double heading, double speed) {
  Rig rig = MakePaperRig();
  rig.scanners.resize(1);
  rig.scanners[0].body_from_scanner.rotation = RotationFromRollPitchYaw(0.0, 0.0, yaw);
  rig.scanners[0].scan_rate_hz = 20.0;
  const auto pose = [&](int64_t time_ns) {
    const double t = SecondsBetween(SixWalls::kStartNs, time_ns) - 2.0;
    return Rigid3d{RotationFromRollPitchYaw(0.0, 0.0, heading),
                   speed * t * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0)};
  };
  std::mt19937_64 random(1);
  std::vector<ScanLine> lines;
  for (int k = 0; k < 80; ++k) {
    lines.push_back(SixWalls::Take(SixWalls::Room(),
                                   rig,
                                   SixWalls::kStartNs + NanosecondsFromSeconds(k / 20.0),
                                   pose,
                                   &random)
                        .front());
  }
  return SegmentSample(lines, SixWalls::kRangeNoise);
}

TEST(TravelDirectionTest, IsTheWayOfTheRigInTheScannersFrame) {
  for (const double yaw_deg : {0.0, 40.0, 178.0, -120.0}) {
    const auto found =
        FindTravelDirection(FindMoves(Drive(yaw_deg * kRadiansPerDegree, 0.7, 0.5)));
    ASSERT_TRUE(found) << yaw_deg;
    const double error =
        std::remainder(found->angle_rad + yaw_deg * kRadiansPerDegree, 2.0 * M_PI);
    EXPECT_LT(std::abs(error), 1.5 * kRadiansPerDegree) << yaw_deg;
    EXPECT_LT(found->spread_rad, 3.0 * kRadiansPerDegree);
    EXPECT_GE(found->num_steps, 5);
  }
}

TEST(TravelDirectionTest, ARigThatStandsShowsNone) {
  EXPECT_FALSE(FindTravelDirection(FindMoves(Drive(0.3, 0.7, 0.0))));
  EXPECT_FALSE(FindTravelDirection({}));
}

}  // namespace
}  // namespace plumbline
