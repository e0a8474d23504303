#include "simulation/world/path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/util/time.h"
#include "test/testing/test_files.h"

namespace plumbline {
namespace {

PathOptions Options(const std::vector<Eigen::Vector2d>& way_points) {
  PathOptions options;
  options.location = "e.yaml:1";
  for (const Eigen::Vector2d& p : way_points) {
    options.way_points.push_back(
        {p, "e.yaml:" + std::to_string(options.way_points.size() + 2)});
  }
  return options;
}

const std::vector<Eigen::Vector2d> kBent = {{0, 0}, {5, 0}, {5, 4}, {8, 1}};
const std::vector<Eigen::Vector2d> kSquare = {{2, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}};

double HeadingOf(const Rigid3d& pose) {
  const Eigen::Vector3d forward = pose.rotation * Eigen::Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

TEST(Path, CornerEndsWhereACircleWould) {
  PathOptions options = Options({{0, 0}, {5, 0}, {5, 4}});
  options.corner_radius_m = 0.8;
  const Path path(options);
  const double corner_m = path.lap_length_m() - 4.2 - 3.2;
  EXPECT_LT((path.PlaceAndHeadingAt(4.2) - Eigen::Vector3d(4.2, 0, 0)).norm(), 1e-12);
  EXPECT_LT(
      (path.PlaceAndHeadingAt(4.2 + corner_m) - Eigen::Vector3d(5, 0.8, M_PI / 2)).norm(),
      1e-12);
  // By symmetry the middle lies on the bisector, with half the turn.
  const Eigen::Vector3d middle = path.PlaceAndHeadingAt(4.2 + corner_m / 2);
  EXPECT_NEAR(5 - middle.x(), middle.y(), 1e-12);
  EXPECT_NEAR(middle.z(), M_PI / 4, 1e-12);
}

// Position against an independent quadrature of the heading with many small steps.
TEST(Path, PositionIsTheIntegralOfTheHeading) {
  PathOptions options = Options(kBent);
  options.corner_radius_m = 0.9;
  const Path path(options);
  const int steps = 40000;
  const double step = path.lap_length_m() / steps;
  Eigen::Vector2d sum(0, 0);
  double worst = 0.0;
  for (int i = 0; i < steps; ++i) {
    // Simpson's rule on every step.
    const auto direction = [&](double share) {
      const double heading = path.PlaceAndHeadingAt((i + share) * step).z();
      return Eigen::Vector2d(std::cos(heading), std::sin(heading));
    };
    sum += step / 6 * (direction(0) + 4 * direction(0.5) + direction(1));
    const Eigen::Vector3d place = path.PlaceAndHeadingAt((i + 1) * step);
    worst = std::max(worst, (sum - place.head<2>()).norm());
  }
  EXPECT_LT(worst, 1e-9);
}

TEST(Path, SpeedIsConstantAndYawRateSmooth) {
  PathOptions options = Options(kSquare);
  options.closed = true;
  options.laps = 1.5;
  options.speed_m_s = 1.3;
  options.corner_radius_m = 0.8;
  const Path path(options);
  const int64_t step_ns = 1000000;
  const double step_s = 1e-3;
  double last_rate = 0.0;
  double fastest = 0.0;
  double largest_jump = 0.0;
  const int64_t end = path.end_ns() - step_ns;
  for (int64_t t = path.start_ns(); t < end; t += step_ns) {
    const Rigid3d a = path.PoseAt(t);
    const Rigid3d b = path.PoseAt(t + step_ns);
    EXPECT_NEAR((b.translation - a.translation).norm() / step_s, 1.3, 1e-4);
    const double rate = std::remainder(HeadingOf(b) - HeadingOf(a), 2 * M_PI) / step_s;
    largest_jump = std::max(largest_jump, std::abs(rate - last_rate));
    fastest = std::max(fastest, std::abs(rate));
    last_rate = rate;
  }
  // The curvature 2 turn / length * sin^2(pi s / length) has the greatest value
  // 2 turn / length and the greatest slope 2 pi turn / length^2.
  const double corner_m = (path.lap_length_m() - 4 * 4.0 + 8 * 0.8) / 4;
  EXPECT_NEAR(fastest, 1.3 * M_PI / corner_m, 1e-4);
  EXPECT_LT(largest_jump, 1.01 * 1.3 * 1.3 * M_PI * M_PI / (corner_m * corner_m) * step_s);
}

TEST(Path, FastCornerTakesOneSecond) {
  PathOptions options = Options({{0, 0}, {5, 0}, {5, 4}});
  options.corner_radius_m = 0.58441;
  const Path path(options);
  EXPECT_NEAR(path.lap_length_m() - 9.0 + 2 * 0.58441, 1.0, 1e-5);
}

TEST(Path, ClosedPathsRepeat) {
  PathOptions options = Options(kSquare);
  options.closed = true;
  options.laps = 3.25;
  options.start_fraction = 0.5;
  const Path path(options);
  EXPECT_NEAR(
      SecondsBetween(path.start_ns(), path.end_ns()), 3.25 * path.lap_length_m(), 1e-8);
  const Rigid3d start = path.PoseAt(0);
  EXPECT_NEAR(start.translation.x(), 2.0, 1e-9);
  EXPECT_NEAR(start.translation.y(), 4.0, 1e-9);
  EXPECT_NEAR(std::abs(HeadingOf(start)), M_PI, 1e-9);
  const Rigid3d later = path.PoseAt(NanosecondsFromSeconds(path.lap_length_m()));
  EXPECT_LT((later.translation - start.translation).norm(), 2e-9);
}

TEST(Path, OscillationsComputedByHand) {
  PathOptions options = Options({{0, 0}, {5, 0}});
  options.start_ns = 1400000000000000000;
  options.roll = {0.05, 1.0, 0.0};
  options.pitch = {0.03, 0.5, M_PI / 2};
  options.height = {0.02, 2.0, 0.0};
  const Path path(options);
  const Rigid3d pose = path.PoseAt(options.start_ns + 250000000);
  const Eigen::Quaterniond expected =
      RotationFromRollPitchYaw(0.05, 0.03 * std::cos(M_PI / 4), 0.0);
  EXPECT_LT(pose.rotation.angularDistance(expected), 1e-7);
  EXPECT_LT((pose.translation - Eigen::Vector3d(0.25, 0, 1.5)).norm(), 1e-12);
  EXPECT_NEAR(path.PoseAt(options.start_ns + 125000000).translation.z(), 1.52, 1e-12);
}

TEST(Path, PausesStopSmoothly) {
  PathOptions options = Options({{0, 0}, {10, 0}});
  options.speed_m_s = 2.0;
  options.pauses = {{3.0, 1.5, "e.yaml:9"}, {6.0, 0.5, "e.yaml:10"}};
  const Path path(options);
  // 5 s at full speed, the pauses, and twice half a second for slowing down and speeding up.
  EXPECT_EQ(path.end_ns(), NanosecondsFromSeconds(5.0 + 1.5 + 0.5 + 2 * 1.0));
  EXPECT_NEAR(path.TravelledAt(path.end_ns()), 10.0, 1e-9);
  // Slows down from 2 m on, which it reaches after 1 s, and stands from 2 s to 3.5 s.
  EXPECT_NEAR(path.TravelledAt(1000000000), 2.0, 1e-9);
  EXPECT_NEAR(path.TravelledAt(2000000000), 3.0, 1e-9);
  EXPECT_NEAR(path.TravelledAt(3500000000), 3.0, 1e-9);
  EXPECT_NEAR(path.TravelledAt(4500000000), 4.0, 1e-9);
  double last_speed = 2.0;
  for (int64_t t = 0; t < path.end_ns() - 1000000; t += 1000000) {
    const double speed = (path.TravelledAt(t + 1000000) - path.TravelledAt(t)) / 1e-3;
    // |acceleration| <= speed * pi / 2 for a ramp of one second.
    EXPECT_NEAR(speed, last_speed, 1.01 * 2.0 * M_PI / 2 * 1e-3);
    last_speed = speed;
  }
}

TEST(Path, ErrorsNameTheWayPoint) {
  PathOptions options = Options(kBent);
  options.corner_radius_m = 2.0;
  EXPECT_EQ(ErrorOf([&] { Path path(options); }),
            "e.yaml:4: corners of this radius do not fit between this way point and the one "
            "before it");
  EXPECT_EQ(ErrorOf([&] {
              Path path(Options({{0, 0}, {5, 0}, {1, 0}}));
            }),
            "e.yaml:3: the path turns back on itself at this way point");
  EXPECT_EQ(ErrorOf([&] {
              Path path(Options({{0, 0}, {5, 0}, {5, 0}}));
            }),
            "e.yaml:4: the same way point stands twice");
  EXPECT_EQ(ErrorOf([&] {
              Path path(Options({{0, 0}}));
            }),
            "e.yaml:1: a path needs at least two way points, three if closed");
  options = Options({{0, 0}, {5, 0}});
  options.length_m = 6.0;
  EXPECT_EQ(ErrorOf([&] { Path path(options); }),
            "e.yaml:1: the path is only 5.000000 m long");
  options.length_m = 0.0;
  options.pauses = {{0.1, 1.0, "e.yaml:8"}};
  EXPECT_EQ(ErrorOf([&] { Path path(options); }),
            "e.yaml:8: no room to slow down and speed up for this pause; pauses stand in the "
            "order in which they come");
}

}  // namespace
}  // namespace plumbline
