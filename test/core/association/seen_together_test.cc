#include "core/association/seen_together.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/util/time.h"
#include "test/testing/plane_scene.h"

namespace plumbline {
namespace {

constexpr double kFlatness = 0.003;  // m

// A level scanner at rest in the origin looks at two pieces of wall across its x axis.
class SeenTogetherTest : public testing::Test {
 protected:
  SeenTogetherTest() {
    rig_.scanners.resize(1);
    rig_.scanners[0].range_noise_m = 0.03;
    rig_.scanners[0].beams = 181;  // beam i points to i - 90 degrees
    rig_.scanners[0].field_of_view_deg = 180.0;
    state_.trajectory.ExtendTo(NanosecondsFromSeconds(30.0));
    for (const double y : {-1.5, 1.5}) {
      Landmark landmark = MakeVerticalLandmark({-1.0, 0.0, 0.0}, {4.0, y, 0.0});
      landmark.id = static_cast<int>(state_.landmarks.size());
      landmark.extent.AddSegment({4.0, y - 1.0, 0.0}, {4.0, y + 1.0, 0.0});
      landmark.first_scan = 0;
      landmark.last_scan = 1000;
      // Both may be off by a decimetre: the drift of the poses.
      landmark.covariance = Eigen::Vector3d(1e-8, 1e-2, 0.0).asDiagonal();
      state_.landmarks.push_back(landmark);
    }
  }

  // Sees the plane x = x, as the landmark id, in twenty scans from an instant on.
  void See(int id, double x, double start_s) {
    const ScenePlane wall = {{-1.0, 0.0, 0.0}, -x};
    for (int i = 0; i < 20; ++i) {
      const ScanLine line = TakeScanLine(
          {wall},
          rig_.scanners[0],
          0,
          NanosecondsFromSeconds(start_s + 0.025 * i),
          [](int64_t) { return Rigid3d(); },
          rig_.scanners[0].range_noise_m,
          &random_);
      const int first = id == 0 ? 60 : 101;
      Observation observation =
          ObservePlane(line, rig_.scanners[0], Rigid3d(), wall, first, first + 20);
      observation.landmark_id = id;
      observation.scan_index = static_cast<int>(std::lround(40.0 * start_s)) + i;
      state_.observations.push_back(observation);
    }
  }

  bool LieApartNow() const {
    return LieApart(rig_, state_, state_.landmarks[0], state_.landmarks[1], kFlatness);
  }

  Rig rig_;
  MapState state_{Trajectory(0, 125'000'000, Rigid3d()), {}, {}, 0};
  std::mt19937_64 random_{1};
};

TEST_F(SeenTogetherTest, PiecesOfOneWallDoNotLieApart) {
  for (const double start : {1.1, 5.1, 9.1}) {
    See(0, 4.0, start);
    See(1, 4.0, start);
  }
  EXPECT_FALSE(LieApartNow());
}

TEST_F(SeenTogetherTest, WallsThreeCentimetresApartLieApart) {
  for (const double start : {1.1, 5.1, 9.1}) {
    See(0, 4.0, start);
    See(1, 4.03, start);
  }
  EXPECT_TRUE(LieApartNow());
  state_.landmarks[0].covariance(0, 0) = 1e-3;
  EXPECT_FALSE(LieApartNow()) << "the first one's direction may lead there";
}

TEST_F(SeenTogetherTest, WhatMovesBothAlikeTellsThemNotApart) {
  for (const double drift : {0.0, 0.05, 0.1}) {
    See(0, 4.0 + drift, 1.1 + 100.0 * drift);
    See(1, 4.0 + drift, 1.1 + 100.0 * drift);
  }
  EXPECT_FALSE(LieApartNow());
}

TEST_F(SeenTogetherTest, WhatIsNeverSeenTogetherIsNotCompared) {
  See(0, 4.0, 1.1);
  See(1, 4.1, 5.1);
  EXPECT_FALSE(LieApartNow());
}

}  // namespace
}  // namespace plumbline
