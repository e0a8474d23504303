#include "core/association/plane_merging.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test/testing/plane_scene.h"

namespace plumbline {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

constexpr double kSigmaDistance = 0.002;  // m
constexpr double kSigmaAngle = 0.001;     // rad

class PlaneMergingTest : public testing::Test {
 protected:
  PlaneMergingTest() { options_.association.surface_flatness_m = 1e-4; }

  // A piece of the wall y = 2 from first_x to last_x, moved and turned about its middle.
  Landmark& AddWall(double first_x, double last_x, double shift = 0.0, double turn = 0.0) {
    const double middle_x = 0.5 * (first_x + last_x);
    const double heading = -M_PI / 2.0 + turn;
    Landmark landmark = MakeVerticalLandmark({std::cos(heading), std::sin(heading), 0.0},
                                             {middle_x, 2.0 + shift, 0.0});
    landmark.extent.AddSegment({first_x, 2.0, 0.2}, {last_x, 2.0, 1.7});
    // Known at its middle: distance and angle there do not correlate.
    Eigen::Matrix2d by_middle;
    const Eigen::Vector3d along = landmark.extent.axes().u;
    by_middle = landmark.DeviationJacobian({middle_x, 2.0, 0.0}, along).leftCols<2>();
    const Eigen::Matrix2d inverse = by_middle.inverse();
    landmark.covariance.topLeftCorner<2, 2>() =
        inverse *
        Eigen::Vector2d(kSigmaDistance * kSigmaDistance, kSigmaAngle * kSigmaAngle)
            .asDiagonal() *
        inverse.transpose();
    return Add(landmark);
  }

  // A piece of a round wall about the z axis between two angles; facing 1: seen from outside,
  // -1: from inside.
  Landmark& AddArc(double first, double last, double radius_m, double facing = 1.0) {
    const auto at = [&](double angle, double z) {
      return Eigen::Vector3d(radius_m * std::cos(angle), radius_m * std::sin(angle), z);
    };
    const Eigen::Vector3d middle = at(0.5 * (first + last), 0.0);
    Landmark landmark =
        MakeCylinderLandmark(facing * middle.normalized(), facing / radius_m, middle);
    constexpr int kNumChords = 10;
    const double step = (last - first) / kNumChords;
    for (int i = 0; i < kNumChords; ++i) {
      landmark.extent.AddSegment(at(first + i * step, 0.2), at(first + (i + 1) * step, 1.7));
    }
    constexpr double kSigmaCurvature = 1e-4;  // 1/m
    landmark.covariance.diagonal() << std::pow(kSigmaAngle, 2), std::pow(kSigmaCurvature, 2),
        std::pow(kSigmaDistance, 2);
    return Add(landmark);
  }

  Landmark& Add(Landmark landmark) {
    landmark.id = static_cast<int>(state_.landmarks.size());
    landmark.num_segments = 10;
    landmark.num_points = 500;
    landmark.first_scan = 10 * landmark.id;
    landmark.last_scan = 10 * landmark.id + 9;
    state_.landmarks.push_back(landmark);
    return state_.landmarks.back();
  }

  Pairs Find(int since_scan = 0) { return FindMergeable(rig_, state_, options_, since_scan); }

  Rig rig_ = MakePaperRig();
  MapperOptions options_;
  MapState state_{Trajectory(0, 125'000'000, Rigid3d()), {}, {}, 0, {}};
};

TEST_F(PlaneMergingTest, NeighbouringPiecesOfOneWallAreOne) {
  AddWall(0.0, 2.0);
  AddWall(2.5, 4.5);
  EXPECT_EQ(Find(), (Pairs{{0, 1}}));
}

TEST_F(PlaneMergingTest, SignificantDifferenceKeepsThemApart) {
  AddWall(0.0, 2.0);
  // Seen from one piece, the other one's angle counts over 2.2 m as well.
  const double sigma =
      std::sqrt(2.0 * kSigmaDistance * kSigmaDistance + std::pow(2.2 * kSigmaAngle, 2));
  AddWall(1.2, 3.2, 6.0 * sigma);
  EXPECT_EQ(Find(), Pairs());
  state_.landmarks.pop_back();
  AddWall(1.2, 3.2, 2.0 * kSigmaDistance);
  EXPECT_EQ(Find(), (Pairs{{0, 1}}));
  state_.landmarks.pop_back();
  AddWall(1.2, 3.2, 0.0, 7.0 * std::sqrt(2.0) * kSigmaAngle);
  EXPECT_EQ(Find(), Pairs());
}

TEST_F(PlaneMergingTest, PiecesFarFromEachOtherStayTwo) {
  AddWall(0.0, 2.0);
  AddWall(5.0, 7.0);
  EXPECT_EQ(Find(), Pairs());
  options_.association.max_gap_m = 4.0;
  EXPECT_EQ(Find(), (Pairs{{0, 1}}));
}

TEST_F(PlaneMergingTest, TwoSidesOfAThinWallStayTwo) {
  AddWall(0.0, 2.0);
  AddWall(0.0, 2.0, 0.0, M_PI);
  EXPECT_EQ(Find(), Pairs());
}

TEST_F(PlaneMergingTest, TypesDoNotMix) {
  AddWall(0.0, 2.0);
  Landmark floor = MakeHorizontalLandmark(1.0, {1.0, 2.0, 0.2});
  floor.covariance(0, 0) = kSigmaDistance * kSigmaDistance;
  floor.extent.AddSegment({0.0, 2.0, 0.2}, {2.0, 2.0, 0.2});
  Add(floor);
  EXPECT_EQ(Find(), Pairs());
  Add(floor);
  EXPECT_EQ(Find(), (Pairs{{1, 2}}));
  state_.landmarks.pop_back();
  floor.chart.sign = -1.0;
  floor.parameters[0] = -0.2;
  Add(floor);
  EXPECT_EQ(Find(), Pairs());
}

// They face different ways where each was founded.
TEST_F(PlaneMergingTest, NeighbouringPiecesOfOneArcAreOne) {
  AddArc(0.0, 1.0, 2.0);
  AddArc(0.9, 2.0, 2.0);
  EXPECT_EQ(Find(), (Pairs{{0, 1}}));
  state_.landmarks.pop_back();
  AddArc(0.9, 2.0, 2.1);
  EXPECT_EQ(Find(), Pairs());
  state_.landmarks.pop_back();
  AddArc(0.9, 2.0, 2.0, -1.0);
  EXPECT_EQ(Find(), Pairs());
}

TEST_F(PlaneMergingTest, ArcsAreRepeatedByTheirPieces) {
  constexpr double kNoise = 0.03;  // m
  const Landmark arc = AddArc(0.0, 2.0, 2.0);
  EXPECT_TRUE(IsRedundant(AddArc(1.2, 1.9, 2.0), arc, kNoise));
  EXPECT_FALSE(IsRedundant(AddArc(1.2, 1.9, 2.5), arc, kNoise));
  EXPECT_FALSE(IsRedundant(AddArc(1.2, 1.9, 1.95, -1.0), arc, kNoise)) << "a thin round wall";
  // A chord looks like a wall's piece that faces elsewhere.
  Landmark chord = MakeVerticalLandmark({std::cos(1.7), std::sin(1.7), 0.0},
                                        {2.0 * std::cos(1.7), 2.0 * std::sin(1.7), 0.0});
  chord.extent.AddSegment({2.0 * std::cos(1.6), 2.0 * std::sin(1.6), 0.2},
                          {2.0 * std::cos(1.8), 2.0 * std::sin(1.8), 1.7});
  EXPECT_TRUE(IsRedundant(chord, arc, kNoise));
}

TEST_F(PlaneMergingTest, DoubtfulPlanesWait) {
  AddWall(0.0, 2.0);
  AddWall(0.5, 2.5).covariance *= std::pow(1.2 * 0.03 / kSigmaDistance, 2);
  EXPECT_EQ(Find(), Pairs()) << "known worse than a single range";
}

TEST_F(PlaneMergingTest, OnlyWhatHasBeenSeenLatelyIsCompared) {
  AddWall(0.0, 2.0);
  AddWall(0.5, 2.5);  // last seen in scan 19
  EXPECT_EQ(Find(19), (Pairs{{0, 1}}));
  EXPECT_EQ(Find(20), Pairs());
}

TEST_F(PlaneMergingTest, GapRuleHoldsWithoutLoopClosure) {
  AddWall(0.0, 2.0).last_scan = 9;
  AddWall(0.5, 2.5).first_scan = 200;
  state_.landmarks[1].last_scan = 220;
  options_.loop_closure = {false, 100};
  EXPECT_EQ(Find(), Pairs());
  options_.loop_closure = {false, 191};
  EXPECT_EQ(Find(), (Pairs{{0, 1}}));
  options_.loop_closure = {true, 100};
  EXPECT_EQ(Find(), (Pairs{{0, 1}}));
}

TEST_F(PlaneMergingTest, MergedLandmarkPassesEverythingOn) {
  AddWall(0.0, 2.0);
  AddWall(1.5, 4.5);
  AddWall(8.0, 9.0);
  for (const int id : {0, 1, 1, -1, 2}) {
    Observation& observation = state_.observations.emplace_back();
    observation.landmark_id = id;
    // The first ones of wall 1 are of its first scan.
    observation.scan_index =
        id == 0 ? 0 : state_.landmarks[static_cast<size_t>(std::max(id, 1))].first_scan;
  }
  state_.landmarks[0].first_time_ns = 100;
  state_.landmarks[0].last_time_ns = 200;
  state_.landmarks[1].first_time_ns = 50;
  state_.landmarks[1].last_time_ns = 300;
  MergeInto(0, 1, &state_);
  const int expected[] = {0, 0, 0, -1, 2};
  for (size_t i = 0; i < 5; ++i) EXPECT_EQ(state_.observations[i].landmark_id, expected[i]);
  const Landmark& into = state_.landmarks[0];
  EXPECT_EQ(into.num_segments, 20);
  EXPECT_EQ(into.num_points, 1000);
  EXPECT_EQ(into.first_scan, 0);
  EXPECT_EQ(into.last_scan, 19);
  EXPECT_EQ(into.first_time_ns, 50);
  EXPECT_EQ(into.last_time_ns, 300);
  EXPECT_TRUE(into.extent.IsNear({4.4, 2.0, 1.7}, {4.4, 2.0, 1.7}, 0.0));
  EXPECT_EQ(state_.landmarks[1].num_segments, 0);
  EXPECT_TRUE(state_.landmarks[1].extent.empty());
  EXPECT_EQ(Find(), Pairs()) << "what is merged is not compared any more";
}

}  // namespace
}  // namespace plumbline
