#include "core/following/thin_evidence.h"

#include <gtest/gtest.h>

#include "core/following/scan_on_planes.h"
#include "core/surface/landmark.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 0;      // ns
constexpr double kPeriod = 0.025;  // s

// A corridor along x: two long walls beside the rig, and two across it.
class ThinEvidenceTest : public testing::Test {
 protected:
  ThinEvidenceTest() {
    AddWall({0.0, 1.0, 0.0}, {0.0, -1.0, 0.0}, {10.0, -1.0, 0.0});
    AddWall({0.0, -1.0, 0.0}, {0.0, 1.0, 0.0}, {10.0, 1.0, 0.0});
    AddWall({-1.0, 0.0, 0.0}, {5.0, -1.0, 0.0}, {5.0, 1.0, 0.0});
    AddWall({1.0, 0.0, 0.0}, {-5.0, -1.0, 0.0}, {-5.0, 1.0, 0.0});
  }

  void AddWall(const Eigen::Vector3d& normal,
               const Eigen::Vector3d& start,
               const Eigen::Vector3d& end) {
    Landmark landmark = MakeVerticalLandmark(normal, start);
    landmark.extent.AddSegment(start, end);
    landmark.num_segments = 1;
    landmark.id = static_cast<int>(state_.landmarks.size());
    state_.landmarks.push_back(std::move(landmark));
  }

  // The next scan has these numbers of points on each wall.
  void See(const std::vector<int>& num_points) {
    now_ns_ += NanosecondsFromSeconds(kPeriod);
    first_ = static_cast<int>(state_.observations.size());
    for (size_t wall = 0; wall < num_points.size(); ++wall) {
      if (num_points[wall] == 0) continue;
      Observation observation;
      observation.landmark_id = static_cast<int>(wall);
      observation.num_points = num_points[wall];
      observation.sigma_offset_m = 0.005F;
      observation.start_ns = static_cast<int32_t>(now_ns_);
      observation.end_ns = static_cast<int32_t>(now_ns_);
      state_.observations.push_back(std::move(observation));
    }
  }

  // How many observations are withheld where the rig would be shifted along the corridor,
  // whose position along it is known to sigma_m.
  size_t NumWithheld(double shift_m, double sigma_m) {
    return NumWithheldAlong(Eigen::Vector3d::UnitX(), shift_m, sigma_m);
  }
  // The same along another axis.
  size_t NumWithheldAlong(const Eigen::Vector3d& axis, double shift_m, double sigma_m) {
    const Eigen::Vector3d variances =
        Eigen::Vector3d::Constant(1e-6) + sigma_m * sigma_m * axis;
    return thin_
        .Withhold(state_,
                  first_,
                  static_cast<int>(state_.observations.size()) - 1,
                  Eigen::Vector3d::Zero(),
                  variances.asDiagonal(),
                  shift_m * axis)
        .size();
  }

  // Adds a floor, and returns its number.
  size_t AddFloor(double height_m) {
    Landmark landmark = MakeHorizontalLandmark(1.0, {0.0, 0.0, height_m});
    landmark.num_segments = 1;
    landmark.id = static_cast<int>(state_.landmarks.size());
    state_.landmarks.push_back(std::move(landmark));
    return state_.landmarks.size() - 1;
  }

  bool HeightOfScanIsOpen() const {
    return HeightIsOpen(state_,
                        first_,
                        static_cast<int>(state_.observations.size()) - 1,
                        options_.association.surface_flatness_m);
  }

  bool WallsLeaveScanOpen() const {
    return WallsLeaveOpen(state_,
                          first_,
                          static_cast<int>(state_.observations.size()) - 1,
                          options_.planes.small_m,
                          options_.association.surface_flatness_m);
  }

  MapperOptions options_;
  MapState state_{Trajectory(kStart, 125'000'000, Rigid3d()), {}, {}, kStart, {}};
  ThinEvidence thin_;
  int64_t now_ns_ = kStart;
  int first_ = 0;
};

TEST_F(ThinEvidenceTest, OnePlaneWithFewPointsIsNotBelievedAtOnce) {
  See({300, 300, 16});
  EXPECT_EQ(NumWithheld(0.2, 0.05), 1u);
}

TEST_F(ThinEvidenceTest, IsBelievedWhereTheDirectionWasKnown) {
  See({300, 300, 16});
  EXPECT_EQ(NumWithheld(0.2, 0.02), 0u);
}

TEST_F(ThinEvidenceTest, ManyPointsOrASecondPlaneAreBelieved) {
  See({300, 300, 60});
  EXPECT_EQ(NumWithheld(0.2, 0.05), 0u);
  See({300, 300, 16, 8});
  EXPECT_EQ(NumWithheld(0.2, 0.05), 0u);
}

TEST_F(ThinEvidenceTest, WhatStandsStillIsBelievedAfterAWhile) {
  int num_withheld_scans = 0;
  for (int scan = 0; scan < 20; ++scan) {
    See({300, 300, 16});
    if (NumWithheld(0.2 + 0.001 * scan, 0.05) == 0) break;
    ++num_withheld_scans;
  }
  EXPECT_NEAR(num_withheld_scans * kPeriod, 0.25, 1.5 * kPeriod);
}

TEST_F(ThinEvidenceTest, WhoWalksIsNotBelieved) {
  constexpr double kSpeed = 0.6;  // m/s
  for (int scan = 0; scan < 80; ++scan) {
    See({300, 300, 16});
    EXPECT_EQ(NumWithheld(0.2 + kSpeed * kPeriod * scan, 0.05), 1u) << scan;
  }
}

// A few beams at the edge of a tread look like those on the next one.
TEST_F(ThinEvidenceTest, OneTreadIsNotBelievedAtOnce) {
  ASSERT_EQ(AddFloor(-1.5), 4u);
  See({300, 300, 0, 0, 7});
  EXPECT_EQ(NumWithheldAlong(Eigen::Vector3d::UnitZ(), 0.2, 0.05), 1u);
  EXPECT_EQ(NumWithheldAlong(Eigen::Vector3d::UnitZ(), 0.2, 0.02), 0u);
  See({300, 300, 0, 0, 60});
  EXPECT_EQ(NumWithheldAlong(Eigen::Vector3d::UnitZ(), 0.2, 0.05), 0u);
  AddFloor(1.1);
  See({300, 300, 0, 0, 7, 7});
  EXPECT_EQ(NumWithheldAlong(Eigen::Vector3d::UnitZ(), 0.2, 0.05), 0u);
}

TEST_F(ThinEvidenceTest, WallsLeaveTheHeightOpen) {
  AddFloor(-1.5);
  See({300, 300, 16, 16});
  EXPECT_TRUE(HeightOfScanIsOpen());
  See({300, 300, 0, 0, 30});
  EXPECT_TRUE(HeightOfScanIsOpen());  // 5 mm, and as much for the floor's unevenness
  state_.observations.back().sigma_offset_m = 0.002F;
  EXPECT_FALSE(HeightOfScanIsOpen());
}

TEST_F(ThinEvidenceTest, WallsAlongTheCorridorLeaveItOpen) {
  See({300, 300});
  EXPECT_TRUE(WallsLeaveScanOpen());
  See({300, 300, 16});
  EXPECT_FALSE(WallsLeaveScanOpen());
}

// What is no wider than a person or a door's leaf is no wall.
TEST_F(ThinEvidenceTest, NarrowPlanesAreNoWalls) {
  AddWall({-1.0, 0.0, 0.0}, {2.0, -0.3, 0.0}, {2.0, 0.3, 0.0});
  See({300, 300, 0, 0, 40});
  EXPECT_TRUE(WallsLeaveScanOpen());
}

}  // namespace
}  // namespace plumbline
