#include "core/batch/batch_policies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/util/time.h"
#include "test/testing/plane_scene.h"

namespace plumbline {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kRangeNoise = 0.03;  // m

// A level scanner at rest in the origin, and walls across its x axis.
class BatchPoliciesTest : public testing::Test {
 protected:
  BatchPoliciesTest() {
    rig_.scanners.resize(1);
    rig_.scanners[0].range_noise_m = kRangeNoise;
    rig_.scanners[0].beams = 181;  // beam i points to i - 90 degrees
    rig_.scanners[0].field_of_view_deg = 180.0;
    state_.trajectory.ExtendTo(NanosecondsFromSeconds(1.0));
  }

  // The plane x = x, seen from first_y to last_y by so many points.
  Landmark& AddWall(double x, double first_y, double last_y, int num_points = 100) {
    const Eigen::Vector3d middle(x, 0.5 * (first_y + last_y), 0.0);
    Landmark landmark = MakeVerticalLandmark({-1.0, 0.0, 0.0}, middle);
    landmark.id = static_cast<int>(state_.landmarks.size());
    landmark.num_segments = 1;
    landmark.num_points = num_points;
    landmark.extent.AddSegment({x, first_y, 0.0}, {x, last_y, 0.0});
    landmark.covariance = Eigen::Vector3d(1e-6, 1e-6, 0.0).asDiagonal();
    state_.landmarks.push_back(landmark);
    return state_.landmarks.back();
  }

  Observation MakeSegment(int id, int scan_index, int num_points) const {
    Observation observation;
    observation.landmark_id = id;
    observation.scan_index = scan_index;
    observation.num_points = num_points;
    return observation;
  }
  void AddSegment(int id, int scan_index = 0, int num_points = 10) {
    state_.observations.push_back(MakeSegment(id, scan_index, num_points));
  }
  void AddSubMinimumSegment(int id, int num_points) {
    state_.sub_minimum_segments.push_back(MakeSegment(id, 0, num_points));
  }

  // Adds what the scanner sees of the plane x = x between two angles in whole degrees, as a
  // segment on the landmark.
  void See(int id, double x, int first_deg, int last_deg, int scan_index) {
    const ScenePlane wall = {{-1.0, 0.0, 0.0}, -x};
    const ScanLine line = TakeScanLine(
        {wall},
        rig_.scanners[0],
        0,
        NanosecondsFromSeconds(0.1 + 0.025 * scan_index),
        [](int64_t) { return Rigid3d(); },
        0.0,
        &random_);
    Observation observation =
        ObservePlane(line, rig_.scanners[0], Rigid3d(), wall, first_deg + 90, last_deg + 90);
    observation.landmark_id = id;
    observation.scan_index = scan_index;
    state_.observations.push_back(observation);
  }

  static double Width(const Landmark& landmark) {
    return landmark.extent.max_corner().x() - landmark.extent.min_corner().x();
  }

  std::vector<int> Ids() const {
    std::vector<int> ids;
    for (const Observation& observation : state_.observations) {
      ids.push_back(observation.landmark_id);
    }
    return ids;
  }

  Rig rig_;
  MapperOptions options_;
  MapState state_{Trajectory(0, 125'000'000, Rigid3d()), {}, {}, 0};
  std::mt19937_64 random_{1};
  const PoseCovarianceAt known_ = [](int64_t) { return Matrix6d(Matrix6d::Zero()); };
};

using Ints = std::vector<int>;

TEST_F(BatchPoliciesTest, ReleasedLandmarksAreEmptyAndTheGaugesWallStays) {
  AddWall(2.0, -1.0, 1.0).heading_fixed = true;
  AddWall(3.0, -1.0, 1.0);
  AddWall(4.0, -1.0, 1.0);
  for (const int id : {0, 1, 1, 2, -1}) AddSegment(id);
  EXPECT_EQ(ReleaseObservations({true, true, false}, &state_), 2);
  EXPECT_EQ(Ids(), (Ints{0, -1, -1, 2, -1}));
  EXPECT_FALSE(state_.landmarks[0].extent.empty());
  EXPECT_TRUE(state_.landmarks[1].extent.empty());
  EXPECT_EQ(state_.landmarks[1].num_segments, 0);
  EXPECT_EQ(state_.landmarks[1].num_points, 0);
  EXPECT_FALSE(state_.landmarks[2].extent.empty());
}

TEST_F(BatchPoliciesTest, RebuiltLandmarksKnowTheirSegmentsAlone) {
  AddWall(2.0, -5.0, 5.0);
  AddWall(2.0, -5.0, 5.0);
  See(0, 2.0, -20.0, 20.0, 3);
  See(0, 2.0, -20.0, 20.0, 7);
  AddSubMinimumSegment(0, 4);
  AddSubMinimumSegment(1, 4);
  RebuildLandmarks(rig_, {true, false}, &state_);
  const Landmark& landmark = state_.landmarks[0];
  EXPECT_NEAR(Width(landmark), 4.0 * std::tan(20.0 * kDegree), 1e-5);
  EXPECT_EQ(landmark.num_segments, 2);
  EXPECT_EQ(landmark.num_points, 2 * 41 + 4);
  EXPECT_EQ(landmark.first_scan, 3);
  EXPECT_EQ(landmark.last_scan, 7);
  EXPECT_NEAR(Width(state_.landmarks[1]), 10.0, 1e-9) << "it was not chosen";
  RebuildLandmarks(rig_, &state_);
  EXPECT_TRUE(state_.landmarks[1].extent.empty());
  EXPECT_EQ(state_.landmarks[1].num_points, 0) << "no segment, so no sub-minimum segments";
}

TEST_F(BatchPoliciesTest, RecountLeavesAllButTheNumbersOfSegments) {
  AddWall(2.0, -5.0, 5.0);
  AddWall(3.0, -5.0, 5.0);
  for (const int id : {0, 0, -1, 0}) AddSegment(id);
  RecountSegments(&state_);
  EXPECT_EQ(state_.landmarks[0].num_segments, 3);
  EXPECT_EQ(state_.landmarks[1].num_segments, 0);
  EXPECT_FALSE(state_.landmarks[1].extent.empty());
}

TEST_F(BatchPoliciesTest, SegmentsFindTheirPlanesAnew) {
  AddWall(2.0, -2.0, 2.0);
  AddWall(4.0, -2.0, 2.0);
  for (int scan = 0; scan < 3; ++scan) {
    See(scan == 0 ? -1 : scan - 1, 2.0, -20.0, 20.0, scan);
    See(1, 4.0, -20.0, 20.0, scan);
  }
  See(0, 3.0, -20.0, 20.0, 3);  // between the two planes
  Observation& empty = state_.observations.emplace_back(state_.observations.back());
  empty.num_points = 0;
  empty.landmark_id = -1;
  EXPECT_EQ(Reassociate(rig_, options_, known_, &state_), 3);
  EXPECT_EQ(Ids(), (Ints{0, 1, 0, 1, 0, 1, -1, -1}));
  RebuildLandmarks(rig_, &state_);
  EXPECT_EQ(Reassociate(rig_, options_, known_, &state_), 0);
}

// Where the pose is known badly across a wall, a segment decimetres before it may lie on it.
TEST_F(BatchPoliciesTest, SegmentsAreAskedAtTheirPosesCovariance) {
  AddWall(2.0, -2.0, 2.0);
  See(0, 2.0, -20.0, 20.0, 0);
  See(-1, 2.3, -20.0, 20.0, 1);
  MapState open = state_;
  EXPECT_EQ(Reassociate(rig_, options_, known_, &state_), 0);
  const auto open_in_second_scan = [&](int64_t time_ns) {
    Matrix6d covariance = Matrix6d::Zero();
    covariance(3, 3) = time_ns < state_.observations[1].start_time_ns() ? 0.0 : 0.04;
    return covariance;
  };
  EXPECT_EQ(Reassociate(rig_, options_, open_in_second_scan, &open), 1);
  EXPECT_EQ(open.observations[1].landmark_id, 0);
}

TEST_F(BatchPoliciesTest, ASegmentAloneFarFromAllOthersLeavesItsPlane) {
  AddWall(2.0, -2.0, 2.0);
  See(0, 2.0, -20.0, 20.0, 0);
  See(0, 2.0, -20.0, 20.0, 1);
  See(0, 2.0, 60.0, 70.0, 2);  // from y = 3.5 on, while the others end at 0.7
  RebuildLandmarks(rig_, &state_);
  EXPECT_EQ(Reassociate(rig_, options_, known_, &state_), 1);
  EXPECT_EQ(Ids(), (Ints{0, 0, -1}));
}

TEST_F(BatchPoliciesTest, WhatLiesApartWhereItIsSeenTogetherDoesNotMerge) {
  for (const double first_y : {-2.0, 0.0}) {
    AddWall(4.0, first_y, first_y + 2.0).covariance(1, 1) = 1e-4;
    state_.landmarks.back().last_scan = 10;
  }
  MapState near = state_;
  for (int scan = 0; scan < 3; ++scan) {
    See(0, 4.0, -25, -1, scan);
    See(1, 4.04, 1, 25, scan);
  }
  EXPECT_TRUE(MergePlanes(rig_, options_, {}, &state_).empty());
  EXPECT_EQ(MergePlanes(rig_, options_, {}, &near), (Ints{0}));
}

TEST_F(BatchPoliciesTest, LandmarksMergeInChains) {
  AddWall(2.0, 0.0, 2.0);
  AddWall(2.0, 1.8, 3.8);
  AddWall(2.0, 3.6, 5.6);
  AddWall(6.0, 0.0, 2.0);
  for (const int id : {0, 1, 2, 3}) AddSegment(id);
  options_.association.max_gap_m = 0.1;  // the third is near the second alone
  MapState apart = state_;
  EXPECT_EQ(MergePlanes(rig_, options_, {{0, 1}}, &apart).size(), 1u);
  EXPECT_EQ(MergePlanes(rig_, options_, {}, &state_), (Ints{0, 0}));
  EXPECT_EQ(Ids(), (Ints{0, 0, 0, 3}));
  EXPECT_EQ(state_.landmarks[0].num_segments, 3);
  EXPECT_EQ(state_.landmarks[2].num_segments, 0);
}

TEST_F(BatchPoliciesTest, ContradictedPlanesAreThoseFarWorseThanExpected) {
  AddWall(2.0, -1.0, 1.0);
  AddWall(3.0, -1.0, 1.0);
  for (const int id : {0, 1}) AddSegment(id);
  state_.landmarks[0].num_judged = 900;
  state_.landmarks[0].sum_deviations = 900.0 * 1.0;
  state_.landmarks[1].num_judged = 100;
  // Three times the two that are expected, and two more for all of them together.
  state_.landmarks[1].sum_deviations = 100.0 * 6.0 + 1.9;
  EXPECT_EQ(DropContradictedPlanes(&state_), 0);
  state_.landmarks[1].sum_deviations = 100.0 * 6.0 + 2.1;
  EXPECT_EQ(DropContradictedPlanes(&state_), 1);
  EXPECT_EQ(Ids(), (Ints{0, -1}));
}

TEST_F(BatchPoliciesTest, WhereAllSegmentsDeviateNoneIsContradicted) {
  for (int id = 0; id < 5; ++id) {
    Landmark& wall = AddWall(2.0 + id, -1.0, 1.0);
    AddSegment(id);
    wall.num_judged = 100;
    wall.sum_deviations = 100.0 * 8.0;
  }
  EXPECT_EQ(DropContradictedPlanes(&state_), 0);
}

TEST_F(BatchPoliciesTest, ARedundantPlaneGoesAndTheStrongerOneStays) {
  const double off_m = 2.5 * kRangeNoise;
  AddWall(2.0, -1.0, 1.0, 50).SetPlane({-std::cos(off_m), std::sin(off_m), 0.0}, -2.0);
  AddWall(2.0 + off_m, -2.0, 2.0, 500);
  AddWall(2.0 + 10.0 * kRangeNoise, -1.0, 1.0, 50);
  for (const int id : {0, 0, 1, 2}) AddSegment(id);
  EXPECT_EQ(DropRedundantPlanes(rig_, {}, {}, &state_), 2) << "it meets the stronger one";
  EXPECT_EQ(Ids(), (Ints{-1, -1, 1, 2}));
}

TEST_F(BatchPoliciesTest, TwoThatWereFoundToBeTwoAreNotRedundant) {
  AddWall(2.0, -1.0, 1.0, 50);
  AddWall(2.0, -2.0, 2.0, 500);
  for (const int id : {0, 1}) AddSegment(id);
  EXPECT_EQ(DropRedundantPlanes(rig_, {}, {{0, 1}}, &state_), 0);
  EXPECT_EQ(DropRedundantPlanes(rig_, {}, {}, &state_), 1);
}

TEST_F(BatchPoliciesTest, APlaneThatMeetsTheStrongerOneNowhereIsNotRedundant) {
  AddWall(2.0, -1.0, 1.0, 50);
  AddWall(2.0 + 2.5 * kRangeNoise, -2.0, 2.0, 500);
  for (const int id : {0, 1}) AddSegment(id);
  EXPECT_EQ(DropRedundantPlanes(rig_, {}, {}, &state_), 0);
}

MapperOptions Gap(bool loop_closure) {
  MapperOptions options;
  options.loop_closure = {loop_closure, 100};
  return options;
}

TEST_F(BatchPoliciesTest, AcrossTheGapNoPlaneIsRedundant) {
  AddWall(2.0, -1.0, 1.0, 50).first_scan = 200;
  AddWall(2.0, -2.0, 2.0, 500).last_scan = 50;
  AddSegment(0);
  EXPECT_EQ(DropRedundantPlanes(rig_, Gap(false), {}, &state_), 0);
  EXPECT_EQ(DropRedundantPlanes(rig_, Gap(true), {}, &state_), 1);
}

TEST_F(BatchPoliciesTest, APlaneThatBeamsPassThroughGoes) {
  AddWall(4.0, -3.0, 3.0);
  AddWall(2.0, -0.5, 0.5);
  AddSegment(1);
  // Beams to the farther wall cross all of the nearer one's middle.
  for (const int heading_deg : {-8, -4, 0, 4, 8}) {
    for (int scan = 0; scan < 12; ++scan) {
      See(0, 4.0, heading_deg - 1, heading_deg + 1, scan);
    }
  }
  EXPECT_EQ(DropPassedThrough(rig_, &state_), 1);
  EXPECT_EQ(Ids().front(), -1);
  EXPECT_EQ(Ids().back(), 0);
}

TEST_F(BatchPoliciesTest, APlaneOfTooFewScansIsWeak) {
  AddWall(2.0, -1.0, 1.0);
  AddWall(3.0, -1.0, 1.0);
  for (int scan = 0; scan < 4; ++scan) {
    AddSegment(0, scan);
    if (scan == 0) continue;
    AddSegment(1, scan);
    AddSegment(1, scan);  // more segments of a scan are no more scans
  }
  for (const int id : {0, 1}) AddSubMinimumSegment(id, 3);
  options_.planes.min_scans = 4;
  EXPECT_EQ(DropWeakPlanes(options_.planes, &state_), 6);
  EXPECT_EQ(Ids(), (Ints{0, 0, -1, -1, 0, -1, -1, 0, -1, -1}));
  ASSERT_EQ(state_.sub_minimum_segments.size(), 1U);
  EXPECT_EQ(state_.sub_minimum_segments[0].landmark_id, 0);
}

TEST_F(BatchPoliciesTest, SingleBeamsDoNotKeepAPlane) {
  AddWall(2.0, -1.0, 1.0);
  AddWall(3.0, -1.0, 1.0);
  for (int scan = 0; scan < 4; ++scan) {
    AddSegment(0, scan, 2);
    AddSegment(1, scan, scan == 0 ? 2 : 1);
  }
  options_.planes.min_scans = 4;
  EXPECT_EQ(DropWeakPlanes(options_.planes, &state_), 4);
  EXPECT_EQ(Ids(), (Ints{0, -1, 0, -1, 0, -1, 0, -1}));
}

// With the distance from its anchor a circle can shrink to nothing: its radius would be the
// root of a negative number.
TEST_F(BatchPoliciesTest, ACylinderThatHasVanishedIsNone) {
  for (const double distance_m : {-1.0, -3.0}) {
    AddWall(2.0, -1.0, 1.0);
    Landmark& wall = state_.landmarks.back();
    wall.TakeShapeOf(MakeCylinderLandmark({-1.0, 0.0, 0.0}, 0.25, {2.0, 0.0, 0.0}));
    wall.parameters[2] = distance_m;  // the axis is 4 m behind the anchor
    AddSegment(wall.id);
    AddSubMinimumSegment(wall.id, 5);
  }
  EXPECT_EQ(DropVanishedCylinders(&state_), 1);
  EXPECT_EQ(Ids(), (Ints{0, -1}));
  ASSERT_EQ(state_.sub_minimum_segments.size(), 1U);
  EXPECT_EQ(state_.sub_minimum_segments[0].landmark_id, 0);
}

TEST_F(BatchPoliciesTest, AnObliqueFalsePlaneLosesItsSubMinimumSegmentsToo) {
  AddWall(2.0, -1.0, 1.0);
  AddWall(3.0, -1.0, 1.0);
  for (const int id : {0, 1}) AddSegment(id, 0, 10);
  AddSubMinimumSegment(0, 30);  // three times as many are still possible
  AddSubMinimumSegment(1, 16);
  AddSubMinimumSegment(1, 15);
  EXPECT_EQ(DropObliqueFalsePlanes(&state_), 1);
  EXPECT_EQ(Ids(), (Ints{0, -1}));
  ASSERT_EQ(state_.sub_minimum_segments.size(), 1U);
  EXPECT_EQ(state_.sub_minimum_segments[0].landmark_id, 0);
}

}  // namespace
}  // namespace plumbline
