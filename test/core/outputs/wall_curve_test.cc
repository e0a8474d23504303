#include "core/outputs/wall_curve.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

PlanePatch Wall(double x, double y, double distance) {
  PlanePatch plane;
  plane.normal = Eigen::Vector3d(x, y, 0.0).normalized();
  plane.distance = distance;
  return plane;
}

// Round (1, 2) with radius 3, seen from inside.
PlanePatch Round() {
  PlanePatch plane;
  plane.type = PlaneType::kCylinder;
  plane.normal = -Eigen::Vector3d::UnitX();
  plane.centre = {4.0, 2.0, 1.0};
  plane.distance = -4.0;
  plane.curvature = -1.0 / 3.0;
  return plane;
}

TEST(WallCurve, PointsAndParametersOfALineAgree) {
  const WallCurve curve(Wall(3.0, 4.0, 2.0), 1.2);
  const Eigen::Vector2d p = curve.At(1.5);
  EXPECT_NEAR(curve.SignedDistance(p), 0.0, 1e-12);
  EXPECT_NEAR(curve.Parameter(p), 1.5, 1e-12);
  // s grows to the left of the normal.
  EXPECT_NEAR((curve.At(2.5) - p - Eigen::Vector2d(-0.8, 0.6)).norm(), 0.0, 1e-12);
}

TEST(WallCurve, PointsAndParametersOfAnArcAgree) {
  const WallCurve curve(Round(), 1.2);
  ASSERT_TRUE(curve.IsArc());
  for (const double s : {-4.0, 0.0, 0.1, 5.0}) {
    const Eigen::Vector2d p = curve.At(s);
    EXPECT_NEAR((p - Eigen::Vector2d(1.0, 2.0)).norm(), 3.0, 1e-12);
    EXPECT_NEAR(curve.Parameter(p), s, 1e-12);
    const Eigen::Vector2d normal = curve.NormalAt(p);
    const Eigen::Vector2d ahead = (curve.At(s + 1e-6) - p) / 1e-6;
    EXPECT_NEAR((ahead - Eigen::Vector2d(-normal.y(), normal.x())).norm(), 0.0, 1e-5);
  }
  EXPECT_NEAR(curve.SignedDistance({1.0, 2.0}), 3.0, 1e-12);  // inside is before the wall
}

TEST(WallCurve, ALeaningPlaneIsCutAtTheHeight) {
  PlanePatch plane;
  plane.normal = Eigen::Vector3d(0.8, 0.0, -0.6);
  plane.distance = 0.4;
  const WallCurve curve(plane, 2.0);  // 0.8 x - 0.6 * 2 = 0.4
  EXPECT_NEAR(curve.At(0.7).x(), 2.0, 1e-12);
}

TEST(WallCurve, CrossingsLieOnBoth) {
  int count = 0;
  WallCurve(Wall(1.0, 0.0, 2.0), 0.0)
      .ForEachCrossing({0.0, 1.0}, {8.0, 1.0}, [&](double share, double s) {
        EXPECT_NEAR(share, 0.25, 1e-12);
        EXPECT_NEAR(s, 1.0, 1e-12);
        ++count;
      });
  EXPECT_EQ(count, 1);
  const WallCurve round(Round(), 0.0);
  round.ForEachCrossing({-9.0, 2.0}, {11.0, 2.0}, [&](double share, double s) {
    const Eigen::Vector2d p(-9.0 + 20.0 * share, 2.0);
    EXPECT_NEAR((round.At(s) - p).norm(), 0.0, 1e-9);
    ++count;
  });
  EXPECT_EQ(count, 3);
  round.ForEachCrossing({-9.0, 5.1}, {11.0, 5.1}, [&](double, double) { ++count; });
  EXPECT_EQ(count, 3);
}

TEST(WallCurve, CurvesMeetWhereBothAreZero) {
  const WallCurve line(Wall(0.0, 1.0, 3.0), 0.0);
  const WallCurve round(Round(), 0.0);
  const Eigen::Vector2d p = Meet(line, round, {3.7, 2.9}, 0.5);
  EXPECT_NEAR(p.x(), 1.0 + std::sqrt(8.0), 1e-9);
  EXPECT_NEAR(p.y(), 3.0, 1e-9);
}

TEST(WallCurve, ParallelLinesAndFarPointsDoNotMeet) {
  const WallCurve line(Wall(0.0, 1.0, 3.0), 0.0);
  const Eigen::Vector2d start(0.5, 3.0);
  EXPECT_EQ(Meet(line, WallCurve(Wall(0.01, 1.0, 3.1), 0.0), start, 0.5), start);
  EXPECT_EQ(Meet(line, WallCurve(Wall(1.0, 0.0, 2.0), 0.0), start, 0.5), start);
}

TEST(WallCurve, ThroughTwoPoints) {
  const WallCurve curve = WallCurve::Through({1.0, 1.0}, {3.0, 1.0});
  EXPECT_NEAR(curve.SignedDistance({2.0, 4.0}), 3.0, 1e-12);  // the left side is before it
}

}  // namespace
}  // namespace plumbline
