#include "core/visibility/beam_runs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/surface/landmark_view.h"

namespace plumbline {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kRadius = 2.0;  // m

// The scanner at the origin stands in the middle of an apse of 2 m radius, whose wall is seen
// from -x to +y; there a straight wall goes on along x, and another one may stand in front.
class BeamRunsTest : public ::testing::Test {
 protected:
  BeamRunsTest() {
    line_.angle_min = 0.0;
    line_.angle_increment = 0.5 * kDegree;
    scanner_.range_noise_m = 0.02;
    apse_ =
        MakeCylinderLandmark({-Half(), -Half(), 0.0}, -1.0 / kRadius, {Corner(), Corner(), 0});
    apse_.id = 0;
  }

  static double Half() { return std::sqrt(0.5); }
  static double Corner() { return kRadius * Half(); }

  // Marks the apse as seen from one angle to another.
  void SeeApse(double from_deg, double to_deg) {
    apse_.extent = apse_.EmptyExtent();
    for (double angle = from_deg; angle < to_deg; angle += 2.0) {
      for (const double height : {0.0, 1.0}) {
        apse_.extent.AddSegment(OnApse(angle, height), OnApse(angle + 2.0, height));
      }
    }
  }
  static Eigen::Vector3d OnApse(double angle_deg, double height) {
    return {kRadius * std::cos(angle_deg * kDegree),
            kRadius * std::sin(angle_deg * kDegree),
            height};
  }
  static Landmark Wall(const Eigen::Vector3d& normal,
                       const Eigen::Vector3d& from,
                       const Eigen::Vector3d& to) {
    Landmark wall = MakeVerticalLandmark(normal, from);
    wall.id = 1;
    wall.extent.AddSegment(from, to);
    wall.extent.AddSegment(from + Eigen::Vector3d::UnitZ(), to + Eigen::Vector3d::UnitZ());
    return wall;
  }

  // The beams of half a turn, of ranges by angle.
  template <typename RangeOf>
  void See(const RangeOf& range_of) {
    for (int beam = 0; beam < 361; ++beam) {
      line_.ranges.push_back(static_cast<float>(range_of(line_.BeamAngle(beam))));
    }
  }

  BeamRuns Find(const Landmark& wall) const {
    surfaces_ = PlaneSet({LandmarkView(wall), LandmarkView(apse_)});
    const ScanPlacement placement =
        ScanPlacement::Identity() - Eigen::Vector3d::UnitZ() * Eigen::RowVector3d::UnitZ();
    return FindBeamRuns(
        line_, scanner_, [&](int) { return placement; }, surfaces_, openings_);
  }
  double AngleDeg(int beam) const { return line_.BeamAngle(beam) / kDegree; }

  ScanLine line_;
  Scanner scanner_;
  Landmark apse_;
  mutable PlaneSet surfaces_;
  std::vector<PlaneOpenings> openings_ = std::vector<PlaneOpenings>(2);
};

// An arc's bow grows with the square of its chord: its runs are as short as segments are.
TEST_F(BeamRunsTest, SplitsAnArcIntoSegments) {
  SeeApse(0.0, 180.0);
  See([](double) { return kRadius; });
  const BeamRuns found = Find(Wall({-1.0, 0.0, 0.0}, {9.0, 0.0, 0.0}, {9.0, 1.0, 0.0}));
  ASSERT_FALSE(found.runs.empty());
  int next = found.runs.front().first_beam;
  for (const BeamAssociation::PlaneBeams& run : found.runs) {
    EXPECT_EQ(run.plane->landmark->id, 0);
    EXPECT_EQ(run.first_beam, next);
    const double half_turn = 0.5 * (run.last_beam - run.first_beam) * 0.5 * kDegree;
    EXPECT_LT(kRadius * (1.0 - std::cos(half_turn)), 0.031);
    next = run.last_beam + 1;
  }
  EXPECT_LE(found.runs.front().first_beam, 1);
  EXPECT_GE(found.runs.back().last_beam, 359);
  EXPECT_LT(found.runs.size(), 16u);
}

// Near the place where a wall goes over into an arc no beam tells which it is on, and both
// seem to have been seen beyond it.
TEST_F(BeamRunsTest, NoneOfTwoThatGoOverIntoEachOtherTakesTheBeams) {
  SeeApse(84.0, 180.0);
  const Landmark wall = Wall({0.0, -1.0, 0.0}, {-0.5, kRadius, -0.1}, {4.0, kRadius, -0.1});
  See([](double angle) { return angle < 0.5 * M_PI ? kRadius / std::sin(angle) : kRadius; });
  const BeamRuns found = Find(wall);
  double last_on_wall = 0.0;
  double first_on_arc = 180.0;
  for (const BeamAssociation::PlaneBeams& run : found.runs) {
    if (run.plane->is_curved) {
      first_on_arc = std::min(first_on_arc, AngleDeg(run.first_beam));
    } else {
      last_on_wall = std::max(last_on_wall, AngleDeg(run.last_beam));
    }
  }
  EXPECT_LT(last_on_wall, 90.0);
  EXPECT_GT(first_on_arc, 90.0);
  EXPECT_GT(first_on_arc - last_on_wall, 12.0);
  // Ten degrees from there the arc has turned off.
  EXPECT_GT(last_on_wall, 74.0);
  EXPECT_LT(first_on_arc, 106.0);
}

// A face that stands on the arc takes its own beams, and leaves the arc those beside it.
TEST_F(BeamRunsTest, AtACornerTheNearerSurfaceTellsToTheBeam) {
  SeeApse(0.0, 180.0);
  // Across the x axis: from (1.2, 0) to the apse at 53 degrees.
  const double top = std::sqrt(kRadius * kRadius - 1.2 * 1.2);
  const Landmark face = Wall({-1.0, 0.0, 0.0}, {1.2, 0.0, -0.1}, {1.2, top, -0.1});
  See([](double angle) {
    const double on_face = std::cos(angle) > 0.0 ? 1.2 / std::cos(angle) : 1e9;
    return std::min(on_face, kRadius);
  });
  const BeamRuns found = Find(face);
  const double corner_deg = std::acos(1.2 / kRadius) / kDegree;
  for (size_t i = 0; i + 1 < found.runs.size(); ++i) {
    const BeamAssociation::PlaneBeams& run = found.runs[i];
    const BeamAssociation::PlaneBeams& next = found.runs[i + 1];
    if (run.plane == next.plane) continue;
    EXPECT_FALSE(run.plane->is_curved);
    EXPECT_NEAR(AngleDeg(run.last_beam), corner_deg, 0.5);
    EXPECT_EQ(next.first_beam, run.last_beam + 1);
  }
  EXPECT_FALSE(found.runs.front().plane->is_curved);
  EXPECT_TRUE(found.runs.back().plane->is_curved);
}

// A beam or two that lie on nothing do not end a run, and are none of its beams.
TEST_F(BeamRunsTest, LeavesOutStrayBeams) {
  const Landmark wall = Wall({0.0, -1.0, 0.0}, {-3.0, 1.0, -0.1}, {3.0, 1.0, -0.1});
  SeeApse(0.0, 10.0);
  See([](double angle) { return std::min(1.0 / std::max(1e-9, std::sin(angle)), 2.9); });
  line_.ranges[180] = 0.5F;
  line_.ranges[181] = std::numeric_limits<float>::infinity();
  const BeamRuns found = Find(wall);
  ASSERT_EQ(found.runs.size(), 1u);
  EXPECT_EQ(found.between, (std::vector<int>{180, 181}));
  Observation observation;
  observation.landmark_id = 1;
  observation.first_beam = 170;
  observation.last_beam = 175;
  EXPECT_EQ(found.RunOf(observation, {false}), 0u);
  EXPECT_EQ(found.RunOf(observation, {true}), 1u);
  observation.landmark_id = 0;
  EXPECT_EQ(found.RunOf(observation, {false}), 1u);
}

}  // namespace
}  // namespace plumbline
