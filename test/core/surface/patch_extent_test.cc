#include "core/surface/patch_extent.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace plumbline {
namespace {

PatchExtent WallExtent() {
  return PatchExtent(
      Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ());
}

PatchExtent FloorExtent() {
  return PatchExtent(
      Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
}

PatchExtent ExtentOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  PatchExtent extent = WallExtent();
  extent.AddSegment(a, b);
  return extent;
}

TEST(PatchExtentTest, KnowsWhatHasBeenSeen) {
  PatchExtent extent = WallExtent();
  EXPECT_TRUE(extent.empty());
  EXPECT_FALSE(extent.IsNear({0, 0, 0}, {1, 0, 0}, 100.0));
  extent.AddSegment({-1.0, 5.0, 1.0}, {3.0, 5.0, 2.0});
  EXPECT_FALSE(extent.empty());
  EXPECT_EQ(extent.min_corner(), Eigen::Vector2d(-1.0, 1.0));
  EXPECT_EQ(extent.max_corner(), Eigen::Vector2d(3.0, 2.0));
  // The distance from the plane itself does not matter.
  EXPECT_TRUE(extent.IsNear({0.0, 9.0, 1.3}, {0.1, 9.0, 1.3}, 0.0));
}

// On a cylinder u runs along the arc, whichever side its axis lies on.
TEST(PatchExtentTest, FollowsAnArc) {
  for (const double curvature : {-0.25, 0.25}) {
    PatchExtent extent(
        {1.0, 2.0, 0.0}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ(), curvature);
    const Eigen::Vector3d axis = extent.axes().anchor + Eigen::Vector3d::UnitY() / curvature;
    for (const double u : {-9.0, -2.0, 0.0, 3.0, 12.0}) {
      const Eigen::Vector3d p = extent.ToWorld({u, 0.7});
      EXPECT_NEAR((p - axis).head<2>().norm(), 4.0, 1e-12);
      EXPECT_LT((extent.Project(p) - Eigen::Vector2d(u, 0.7)).norm(), 1e-12);
    }
    // Across the far side of the full circle the way from one end to the other is short.
    const double half = 4.0 * M_PI;
    extent.AddSegment(extent.ToWorld({half - 0.3, 1.0}), extent.ToWorld({half + 0.3, 1.0}));
    EXPECT_LT(extent.max_corner().x() - extent.min_corner().x(), 0.7);
  }
}

// To the size of the grid's cells, which the tests stay away from.
TEST(PatchExtentTest, BoundsReachFromTheMiddleToTheRim) {
  const PatchExtent::Bounds wall =
      ExtentOf({-1.0, 0.0, 1.0}, {3.0, 0.0, 2.0}).BoundsAboutCentre();
  EXPECT_EQ(wall.half_u, Eigen::Vector3d(2.0, 0.0, 0.0));
  EXPECT_EQ(wall.half_v, Eigen::Vector3d(0.0, 0.0, 0.5));
  EXPECT_EQ(wall.ball_m, 0.0);
  PatchExtent arc({2.0, 0.0, 0.0}, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), 0.5);
  arc.AddSegment({2.0, 0.0, 0.0}, {0.0, 2.0, 1.0});
  EXPECT_EQ(arc.BoundsAboutCentre().half_u, Eigen::Vector3d::Zero());
  EXPECT_EQ(arc.BoundsAboutCentre().half_v, Eigen::Vector3d::Zero());
  EXPECT_EQ(arc.BoundsAboutCentre().ball_m, arc.radius_m());
}

// One point does not show how an arc bends.
TEST(PatchExtentTest, ComparesArcsAtTheirEndsToo) {
  const std::vector<Eigen::Vector3d> on_wall =
      ComparedPoints(ExtentOf({-1.0, 0.0, 1.0}, {3.0, 0.0, 2.0}));
  ASSERT_EQ(on_wall.size(), 1u);
  EXPECT_LT((on_wall[0] - Eigen::Vector3d(1.0, 0.0, 1.5)).norm(), 1e-12);
  PatchExtent arc({2.0, 0.0, 0.0}, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), 0.5);
  arc.AddSegment({2.0, 0.0, 0.0}, {0.0, 2.0, 1.0});
  const std::vector<Eigen::Vector3d> on_arc = ComparedPoints(arc);
  ASSERT_EQ(on_arc.size(), 3u);
  EXPECT_LT((on_arc[0] - Eigen::Vector3d(2.0, 0.0, 0.5)).norm(), 1e-12);
  EXPECT_LT((on_arc[1] - Eigen::Vector3d(std::sqrt(2.0), std::sqrt(2.0), 0.5)).norm(), 1e-12);
  EXPECT_LT((on_arc[2] - Eigen::Vector3d(0.0, 2.0, 0.5)).norm(), 1e-12);
}

TEST(PatchExtentTest, NearIsWithinTheGap) {
  const PatchExtent extent = ExtentOf({0.0, 0.0, 1.0}, {4.0, 0.0, 1.0});
  EXPECT_TRUE(extent.IsNear({4.9, 0.0, 1.0}, {6.0, 0.0, 1.0}, 1.0));
  EXPECT_FALSE(extent.IsNear({6.1, 0.0, 1.0}, {7.0, 0.0, 1.0}, 1.0));
  EXPECT_TRUE(extent.IsNear({6.1, 0.0, 1.0}, {7.0, 0.0, 1.0}, 3.0));
  EXPECT_FALSE(extent.IsNear({2.0, 0.0, 3.1}, {3.0, 0.0, 3.1}, 1.0));
  // A long piece of which only the middle is near, and one within the rectangle that is not.
  EXPECT_TRUE(extent.IsNear({2.0, 0.0, -9.0}, {2.0, 0.0, 9.0}, 0.5));
  PatchExtent diagonal = ExtentOf({0.0, 0.0, 0.0}, {8.0, 0.0, 8.0});
  EXPECT_FALSE(diagonal.IsNear({6.0, 0.0, 1.0}, {7.0, 0.0, 1.5}, 1.0));
  EXPECT_TRUE(diagonal.IsNear({6.0, 0.0, 1.0}, {7.0, 0.0, 1.5}, 6.0));
}

TEST(PatchExtentTest, IsSeenOnItsCellsAndAMarginBeside) {
  PatchExtent extent = ExtentOf({0.0, 0.0, 1.0}, {1.1, 0.0, 1.0});
  extent.AddSegment({2.1, 0.0, 1.0}, {3.0, 0.0, 1.0});
  EXPECT_TRUE(extent.IsSeenAt({0.5, 0.0, 1.0}, 0.0));
  EXPECT_FALSE(extent.IsSeenAt({1.6, 0.0, 1.0}, 0.02)) << "between the two";
  EXPECT_TRUE(extent.IsSeenAt({3.019, 0.0, 0.981}, 0.02)) << "on cells that are empty";
  EXPECT_FALSE(extent.IsSeenAt({3.021, 0.0, 1.0}, 0.02));
}

// To an edge at 4 m, past which one segment in twenty went on by mistake, and to a door that
// begins there.
TEST(PatchExtentTest, GoesOnWhereManySegmentsAreSeenAgain) {
  PatchExtent extent = WallExtent();
  for (int i = 0; i < 20; ++i) {
    extent.AddSegment({0.0, 0.0, 1.0}, {i == 0 ? 5.0 : 4.0, 0.0, 1.0});
  }
  const Eigen::Vector3d edge(4.0, 0.0, 1.0);
  EXPECT_FALSE(extent.GoesOnBeyond(edge, Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(extent.GoesOnBeyond(edge, -Eigen::Vector3d::UnitX()));
  for (int i = 0; i < 5; ++i) extent.AddSegment({5.3, 0.0, 1.0}, {7.0, 0.0, 1.0});
  EXPECT_TRUE(extent.GoesOnBeyond(edge, Eigen::Vector3d::UnitX()));
  EXPECT_FALSE(extent.GoesOnBeyond({7.0, 0.0, 1.0}, Eigen::Vector3d::UnitX()));
}

// From a point 3 m in front of the plane and 4 m beside what was seen of it: 5 m.
TEST(PatchExtentTest, ReachIsThatOfTheRectangle) {
  PatchExtent extent = ExtentOf({0.0, 0.0, 0.0}, {2.0, 0.0, 0.0});
  extent.AddSegment({0.0, 0.0, 2.0}, {2.0, 0.0, 2.0});
  EXPECT_TRUE(extent.IsWithinReach({6.0, 3.0, 1.0}, 5.01));
  EXPECT_FALSE(extent.IsWithinReach({6.0, 3.0, 1.0}, 4.99));
  EXPECT_TRUE(extent.IsWithinReach({1.0, -3.0, 1.0}, 3.01)) << "above the rectangle";
  EXPECT_FALSE(extent.IsWithinReach({1.0, -3.0, 1.0}, 2.99));
  EXPECT_FALSE(WallExtent().IsWithinReach({0.0, 0.0, 0.0}, 1e3)) << "nothing was seen";
}

TEST(PatchExtentTest, OthersAreNearLeavesThePieceItselfOut) {
  PatchExtent extent = ExtentOf({0.0, 0.0, 1.0}, {4.0, 0.0, 1.0});
  const Eigen::Vector3d a(5.5, 0.0, 1.0);
  const Eigen::Vector3d b(6.0, 0.0, 1.2);
  extent.AddSegment(a, b);
  EXPECT_TRUE(extent.IsNear(a, b, 1.0)) << "to itself";
  EXPECT_FALSE(extent.OthersAreNear(a, b, 1.0));
  EXPECT_TRUE(extent.OthersAreNear(a, b, 2.0));
  EXPECT_TRUE(extent.OthersAreNear({4.0, 0.0, 1.0}, {3.0, 0.0, 1.0}, 2.0));
  extent.AddSegment(a, b);
  EXPECT_TRUE(extent.OthersAreNear(a, b, 1.0)) << "seen twice";
}

TEST(PatchExtentTest, NearOfTwoExtentsIsMutual) {
  const PatchExtent a = ExtentOf({0.0, 0.0, 1.0}, {4.0, 0.0, 1.0});
  const PatchExtent near = ExtentOf({4.8, 0.0, 1.0}, {6.0, 0.0, 1.0});
  const PatchExtent far = ExtentOf({6.1, 0.0, 1.0}, {9.0, 0.0, 1.0});
  EXPECT_TRUE(a.IsNear(near, 1.0));
  EXPECT_TRUE(near.IsNear(a, 1.0));
  EXPECT_FALSE(a.IsNear(far, 1.0));
  EXPECT_FALSE(far.IsNear(a, 1.0));
  EXPECT_FALSE(a.IsNear(WallExtent(), 1.0));
}

TEST(PatchExtentTest, RectanglesAreNearWhereverCellsAre) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(-6.0, 6.0);
  const auto point = [&] { return Eigen::Vector3d(uniform(random), 0.0, uniform(random)); };
  int num_near = 0;
  int num_maybe = 0;
  constexpr int kCount = 2000;
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Vector3d a = point();
    const Eigen::Vector3d b = a + 0.3 * point();
    const PatchExtent extent = ExtentOf(a, b);
    PatchExtent other(point(), -Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d c = point();
    const Eigen::Vector3d d = c + 0.3 * point();
    other.AddSegment(c, d);
    if (extent.MayBeNear(other, 1.0)) ++num_maybe;
    if (!extent.IsNear(c, d, 1.0)) continue;
    ++num_near;
    EXPECT_TRUE(extent.MayBeNear(other, 1.0));
    EXPECT_TRUE(other.MayBeNear(extent, 1.0));
  }
  EXPECT_GT(num_near, kCount / 20);
  EXPECT_LT(num_maybe, 3 * kCount / 4);
  EXPECT_FALSE(WallExtent().MayBeNear(ExtentOf({0, 0, 0}, {1, 0, 0}), 100.0));
}

TEST(PatchExtentTest, OverlapIsTheSharedPart) {
  const PatchExtent a = ExtentOf({0.1, 0.0, 1.1}, {3.9, 0.0, 1.1});
  const PatchExtent b = ExtentOf({2.1, 0.0, 1.1}, {9.9, 0.0, 1.1});
  EXPECT_EQ(a.OverlapWith(a), 1.0);
  EXPECT_EQ(a.OverlapWith(b), 0.5);
  EXPECT_EQ(b.OverlapWith(a), 0.25);
  EXPECT_EQ(a.OverlapWith(ExtentOf({0.1, 0.0, 3.1}, {3.9, 0.0, 3.1})), 0.0);
  EXPECT_EQ(WallExtent().OverlapWith(a), 0.0);
}

TEST(PatchExtentTest, MergedExtentIsBoth) {
  const Eigen::Vector3d a0(0.1, 0.0, 1.1), a1(3.9, 0.0, 1.1), b0(2.1, 0.0, 2.1),
      b1(9.9, 0.0, 2.9);
  PatchExtent merged = ExtentOf(a0, a1);
  const PatchExtent b = ExtentOf(b0, b1);
  const double area = merged.area_m2() + b.area_m2();
  merged.Merge(b);
  EXPECT_EQ(merged.area_m2(), area);
  EXPECT_EQ(merged.min_corner(), Eigen::Vector2d(0.1, 1.1));
  EXPECT_EQ(merged.max_corner(), Eigen::Vector2d(9.9, 2.9));
  EXPECT_EQ(b.OverlapWith(merged), 1.0);
  const PatchExtent untouched = merged;
  merged.Merge(WallExtent());
  EXPECT_EQ(merged.min_corner(), untouched.min_corner());
  EXPECT_EQ(merged.area_m2(), untouched.area_m2());
}

// The same piece in other axes: moved by whole cells, so that the cells are the same.
TEST(PatchExtentTest, AnchorsDoNotMatterBetweenExtents) {
  PatchExtent other(
      Eigen::Vector3d(5.0, 0.3, -2.0), -Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ());
  other.AddSegment({2.1, 0.0, 1.1}, {9.9, 0.0, 1.1});
  const PatchExtent a = ExtentOf({0.1, 0.0, 1.1}, {3.9, 0.0, 1.1});
  EXPECT_EQ(a.OverlapWith(other), 0.5);
  EXPECT_EQ(other.OverlapWith(a), 0.25);
  EXPECT_TRUE(a.IsNear(other, 0.0));
  EXPECT_FALSE(ExtentOf({0.0, 0.0, 1.1}, {0.9, 0.0, 1.1}).IsNear(other, 0.5));
  PatchExtent merged = a;
  merged.Merge(other);
  EXPECT_LT((merged.min_corner() - Eigen::Vector2d(0.1, 1.1)).norm(), 1e-9);
  EXPECT_LT((merged.max_corner() - Eigen::Vector2d(9.9, 1.1)).norm(), 1e-9);
  EXPECT_EQ(merged.area_m2(), 40 * 0.25 * 0.25);
}

double TwiceArea(const std::vector<Eigen::Vector2d>& polygon) {
  double area = 0.0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    area += a.x() * b.y() - a.y() * b.x();
  }
  return area;
}

TEST(PatchExtentTest, HullIsConvexAndCounterClockwise) {
  PatchExtent extent = FloorExtent();
  EXPECT_TRUE(extent.Outline().empty());
  extent.AddSegment({0, 0, 0}, {4, 1, 0});
  extent.AddSegment({4, 3, 0}, {0, 2, 0});
  extent.AddSegment({1, 1, 0}, {2, 2, 0});
  extent.AddSegment({2, 0.5, 0}, {2, 2.5, 0});
  const std::vector<Eigen::Vector2d> hull = extent.Outline();
  EXPECT_EQ(hull.size(), 4u);
  EXPECT_DOUBLE_EQ(TwiceArea(hull), 16.0);
}

TEST(PatchExtentTest, OutlineOfAWallIsItsRectangle) {
  PatchExtent extent = WallExtent();
  EXPECT_TRUE(extent.Outline().empty());
  extent.AddSegment({0, 0, 1}, {4, 0, 3});
  EXPECT_EQ(extent.Outline(), (std::vector<Eigen::Vector2d>{{0, 1}, {4, 1}, {4, 3}, {0, 3}}));
}

// Also when the points have been reduced to their hull on the way.
TEST(PatchExtentTest, HullHoldsAllPoints) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  PatchExtent extent = FloorExtent();
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d a(uniform(random), uniform(random), 0.0);
    const Eigen::Vector3d b(uniform(random), uniform(random), 0.0);
    extent.AddSegment(a, b);
    points.emplace_back(a.x(), a.y());
    points.emplace_back(b.x(), b.y());
  }
  const std::vector<Eigen::Vector2d> hull = extent.Outline();
  ASSERT_GE(hull.size(), 4u);
  for (size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2d along = hull[(i + 1) % hull.size()] - hull[i];
    for (const Eigen::Vector2d& point : points) {
      const Eigen::Vector2d to_point = point - hull[i];
      ASSERT_GE(along.x() * to_point.y() - along.y() * to_point.x(), -1e-9);
    }
  }
}

}  // namespace
}  // namespace plumbline
