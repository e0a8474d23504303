#include "core/surface/landmark_view.h"

#include <gtest/gtest.h>

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
