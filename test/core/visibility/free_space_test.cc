#include "core/visibility/free_space.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/util/time.h"
#include "test/testing/plane_scene.h"

namespace plumbline {
namespace {

// A horizontal scanner at rest at the origin of the world.
class VisibilityTest : public testing::Test {
 protected:
  VisibilityTest() {
    rig_.scanners.resize(1);
    rig_.scanners[0].range_noise_m = 0.03;
    state_.trajectory.ExtendTo(NanosecondsFromSeconds(1.0));
  }

  // A wall across the x axis, from first_y to last_y.
  int AddWall(double x, double first_y, double last_y) {
    Landmark landmark = MakeVerticalLandmark({-1.0, 0.0, 0.0}, {x, 0.0, 0.0});
    landmark.id = static_cast<int>(state_.landmarks.size());
    landmark.num_segments = 1;
    landmark.extent.AddSegment({x, first_y, 0.0}, {x, last_y, 0.0});
    state_.landmarks.push_back(landmark);
    return landmark.id;
  }

  // `count` segments on a wall at this x.
  void See(int id, double x, double first_y, double last_y, int count) {
    for (int i = 0; i < count; ++i) {
      Observation& observation = state_.observations.emplace_back();
      observation.landmark_id = id;
      observation.start_ns = 100'000'000;
      observation.end_ns = 110'000'000;
      observation.first_point = Eigen::Vector2d(x, first_y).cast<float>();
      observation.last_point = Eigen::Vector2d(x, last_y).cast<float>();
      const Eigen::Vector2f middle = 0.5F * (observation.first_point + observation.last_point);
      observation.measurement = PackedSegment({}, {middle, Eigen::Vector2f::UnitY()});
    }
  }

  Rig rig_;
  MapState state_{Trajectory(0, 125'000'000, Rigid3d()), {}, {}, 0};
};

TEST_F(VisibilityTest, FindsWhatBeamsPassThrough) {
  const int far = AddWall(40.0, -10.0, 10.0);
  const int phantom = AddWall(20.0, -1.0, 1.0);
  const int beside = AddWall(20.0, 8.0, 10.0);
  const int behind = AddWall(60.0, -1.0, 1.0);
  // Through all of the phantom's cells, in the middle of which they lie.
  for (double y = -1.5; y < 1.5; y += 0.1) See(far, 40.0, y, y, 12);
  EXPECT_EQ(FindPassedThrough(rig_, state_), (std::vector<bool>{false, true, false, false}))
      << phantom << beside << behind;
}

// An arc whose axis is the scanner, from -90 to 90 degrees: its ends lie beyond a quarter of
// the circle from the place that it was founded at.
TEST_F(VisibilityTest, FindsCurvedSurfacesThatBeamsPassThrough) {
  constexpr double kRadius = 4.0;  // m
  const int far = AddWall(40.0, -30.0, 30.0);
  for (const bool founded_at_its_end : {false, true}) {
    const double founded_at = founded_at_its_end ? -M_PI / 2.0 : 0.0;
    const auto at = [&](double angle) {
      return Eigen::Vector3d(kRadius * std::cos(angle), kRadius * std::sin(angle), 0.0);
    };
    Landmark arc =
        MakeCylinderLandmark(-at(founded_at) / kRadius, -1.0 / kRadius, at(founded_at));
    arc.id = static_cast<int>(state_.landmarks.size());
    arc.num_segments = 1;
    for (double angle = -M_PI / 2.0; angle < M_PI / 2.0; angle += 0.02) {
      arc.extent.AddSegment(at(angle), at(angle + 0.02));
    }
    EXPECT_NEAR(arc.Width(), M_PI * kRadius, 0.1);
    state_.landmarks.push_back(arc);
  }
  EXPECT_EQ(FindPassedThrough(rig_, state_), (std::vector<bool>{false, false, false}));
  // These beams pass the arcs within 14 degrees of their middle, of 90: a door.
  for (double y = -10.0; y < 10.0; y += 0.5) See(far, 40.0, y, y, 12);
  EXPECT_EQ(FindPassedThrough(rig_, state_), (std::vector<bool>{false, false, false}));
  const int side = AddWall(8.0, -30.0, 30.0);
  for (double y = -30.0; y < 30.0; y += 0.25) See(side, 8.0, y, y, 12);
  EXPECT_EQ(FindPassedThrough(rig_, state_), (std::vector<bool>{false, true, true, false}));
}

TEST_F(VisibilityTest, FewBeamsAreNoEvidence) {
  const int far = AddWall(40.0, -10.0, 10.0);
  AddWall(20.0, -1.0, 1.0);
  for (double y = -1.5; y < 1.5; y += 0.3) See(far, 40.0, y, y, 1);
  EXPECT_EQ(FindPassedThrough(rig_, state_), (std::vector<bool>{false, false}));
}

TEST_F(VisibilityTest, BeamsThatEndNearAPlaneDoNotPassIt) {
  const int far = AddWall(20.1, -10.0, 10.0);
  AddWall(20.0, -1.0, 1.0);
  for (double y = -1.5; y < 1.5; y += 0.1) See(far, 20.1, y, y, 12);
  EXPECT_EQ(FindPassedThrough(rig_, state_), (std::vector<bool>{false, false}));
}

}  // namespace
}  // namespace plumbline
