#include "core/surface/landmark_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace plumbline {
namespace {

TEST(LandmarkViewTest, APlaneIsTheSameEverywhere) {
  const Landmark roof = MakeGeneralLandmark({-0.48, 0.36, -0.8}, {1.0, 2.0, 3.3});
  const LandmarkView view(roof);
  const Eigen::Vector3d p(4.0, -1.0, 2.0);
  std::optional<LandmarkView> storage;
  EXPECT_EQ(&view.Near(p, &storage), &view);
  EXPECT_FALSE(storage.has_value());
  EXPECT_EQ(view.UnitNormalNear(p), roof.Normal());
  EXPECT_EQ(view.SignedDistance(p), roof.SignedDistance(p));
}

// Within a cell of the grid, for a wall along x from 1 to 5 m at y = 2, an arc round the
// origin.
TEST(LandmarkViewTest, ReachesAsFarAsWhatWasSeen) {
  Landmark wall = MakeVerticalLandmark(Eigen::Vector3d::UnitY(), {1.0, 2.0, 0.0});
  wall.extent.AddSegment({1.0, 2.0, 0.0}, {5.0, 2.0, 3.0});
  const LandmarkView flat(wall);
  EXPECT_NEAR(flat.ReachAlong(Eigen::Vector3d::UnitX()), 2.0, 1e-9);
  EXPECT_NEAR(flat.ReachAlong(Eigen::Vector3d::UnitY()), 0.0, 1e-9);
  EXPECT_NEAR(flat.ReachAlong({0.8, 0.0, 0.6}), 0.8 * 2.0 + 0.6 * 1.5, 1e-9);
  EXPECT_TRUE(flat.PlanBox(0.5).min().isApprox(Eigen::Vector2d(0.5, 1.5)));
  EXPECT_TRUE(flat.PlanBox(0.5).max().isApprox(Eigen::Vector2d(5.5, 2.5)));

  Landmark arc = MakeCylinderLandmark(Eigen::Vector3d::UnitX(), 0.5, {2.0, 0.0, 0.0});
  arc.extent.AddSegment({2.0, 0.0, 0.0}, {0.0, 2.0, 1.0});
  const LandmarkView round(arc);
  for (const double angle : {0.0, 0.4, M_PI / 2.0}) {
    const Eigen::Vector3d p(2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.5);
    EXPECT_TRUE(round.PlanBox(0.0).contains(Eigen::Vector2d(p.head<2>())));
    for (const Eigen::Vector3d& along : {Eigen::Vector3d(0.6, 0.8, 0.0), {0.0, -0.6, 0.8}}) {
      EXPECT_LE(std::abs(along.dot(p - round.centre_world)), round.ReachAlong(along));
    }
  }
}

TEST(LandmarkViewTest, ACylinderIsItsTangentPlaneNearAPoint) {
  Landmark cylinder = MakeCylinderLandmark({0.6, 0.8, 0.0}, -0.25, {3.0, -1.0, 1.0});
  cylinder.parameters[2] = 0.01;
  const LandmarkView view(cylinder);
  const Eigen::Vector3d p(4.0, -1.0, 2.0);
  std::optional<LandmarkView> storage;
  const LandmarkView& near = view.Near(p, &storage);
  EXPECT_EQ(&near, &*storage);
  EXPECT_EQ(near.normal, cylinder.NormalNear(p));
  EXPECT_NEAR(near.normal.dot(p) - near.distance, cylinder.SignedDistance(p), 1e-12);
  EXPECT_EQ(near.plane_by_parameters, cylinder.PlaneByParameters(p));
  EXPECT_NEAR(view.UnitNormalNear(p).norm(), 1.0, 1e-12);
  EXPECT_NEAR(view.UnitNormalNear(p).dot(cylinder.NormalNear(p)),
              cylinder.NormalNear(p).norm(),
              1e-12);
}

}  // namespace
}  // namespace plumbline
