#include "core/surface/plane_patches.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <vector>

namespace plumbline {
namespace {

PlanePatch PatchOf(const Landmark& landmark) {
  std::deque<Landmark> landmarks = {landmark};
  landmarks.front().num_segments = 1;
  return PlanePatches(landmarks).front();
}

// A cylinder whose surface has moved off its anchor, with standard deviations of its
// parameters.
Landmark MakeColumn(double curvature) {
  Landmark cylinder = MakeCylinderLandmark({0.6, 0.8, 0.0}, curvature, {3.0, 1.0, 0.2});
  cylinder.extent.AddSegment({3.0, 1.0, 0.2}, {3.8, 0.4, 1.2});
  cylinder.parameters[2] = 0.05;
  cylinder.covariance.diagonal() << 1e-6, 4e-6, 9e-6;
  return cylinder;
}

// The stated deviations are those that the parameters' make of what is stated.
TEST(PlanePatchesTest, RadiusHasTheDeviationOfCurvatureAndDistance) {
  for (const double curvature : {-0.4, 0.4, -1.0 / 13.2}) {
    const Landmark column = MakeColumn(curvature);
    const PlanePatch stated = PatchOf(column);
    double variance = 0.0;
    for (size_t parameter = 0; parameter < 3; ++parameter) {
      constexpr double kStep = 1e-6;
      const auto radius_at = [&](double step) {
        Landmark moved = column;
        moved.parameters[parameter] += step;
        return PatchOf(moved).Radius();
      };
      const double derivative = (radius_at(kStep) - radius_at(-kStep)) / (2.0 * kStep);
      const auto at = static_cast<Eigen::Index>(parameter);
      variance += derivative * derivative * column.covariance(at, at);
    }
    EXPECT_NEAR(stated.sigma_radius_m, std::sqrt(variance), 1e-4 * stated.sigma_radius_m);
  }
}

// Where the whole map shifts, a column keeps its radius.
TEST(PlanePatchesTest, AShiftLeavesTheRadiusKnown) {
  Landmark column = MakeColumn(0.5);
  column.parameters[2] = 0.0;
  // The axis, half a curvature's inverse behind the anchor, moves along the normal by 1 cm.
  constexpr double kShift = 0.01;
  const double k = column.Curvature();
  const Eigen::Vector3d by_shift(0.0, k * k, 1.0);  // of radius 1 / k, to first order
  column.covariance = kShift * kShift * by_shift * by_shift.transpose();
  const PlanePatch stated = PatchOf(column);
  EXPECT_NEAR(stated.sigma_distance_m, kShift, 0.2 * kShift);
  EXPECT_LT(stated.sigma_radius_m, 1e-6);
}

TEST(PlanePatchesTest, EachKindStatesItsOwn) {
  const Eigen::Vector3d p(1.0, 2.0, 0.3);
  Landmark wall = MakeVerticalLandmark({-0.8, 0.6, 0.0}, p);
  wall.covariance.topLeftCorner<2, 2>() << 4e-6, 0.0, 0.0, 9e-6;
  Landmark roof = MakeGeneralLandmark({-0.48, 0.36, -0.8}, p);
  roof.covariance.diagonal() << 1e-6, 4e-6, 9e-6;
  for (Landmark* landmark : {&wall, &roof}) {
    const PlaneAxes axes = landmark->extent.axes();
    landmark->extent.AddSegment(axes.anchor, axes.ToWorld({2.0, 1.0}));
    const PlanePatch patch = PatchOf(*landmark);
    EXPECT_EQ(patch.curvature, 0.0);
    EXPECT_NEAR(patch.SignedDistance(patch.centre), 0.0, 1e-12);
    EXPECT_NEAR(patch.sigma_angle_rad, 2e-3, 1e-9);
  }
  EXPECT_EQ(PatchOf(wall).type, PlaneType::kVertical);
  EXPECT_EQ(PatchOf(roof).type, PlaneType::kGeneral);
  EXPECT_EQ(PatchOf(MakeColumn(0.5)).type, PlaneType::kCylinder);
}

// A floor without segments is none; the wall's parameters are stated as they are, the roof's
// at the patch's centre.
TEST(PlanePatchesTest, AreThoseThatWereSeen) {
  std::deque<Landmark> landmarks = {MakeVerticalLandmark({-0.8, 0.6, 0.0}, {1.0, 2.0, 0.3}),
                                    MakeHorizontalLandmark(1.0, {1.0, 2.0, 0.0}),
                                    MakeGeneralLandmark({-0.48, 0.36, -0.8}, {1.0, 2.0, 3.3})};
  for (int id = 0; id < 3; ++id) {
    Landmark& landmark = landmarks[static_cast<size_t>(id)];
    landmark.id = id;
    landmark.num_segments = landmark.id == 1 ? 0 : 1;
    const PlaneAxes axes = landmark.extent.axes();
    landmark.extent.AddSegment(axes.anchor, axes.ToWorld({2.0, 1.0}));
  }
  const std::vector<PlanePatch> patches = PlanePatches(landmarks);
  ASSERT_EQ(patches.size(), 2u);
  EXPECT_EQ(patches.back().id, 2);
  const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(5, 5);
  const PlaneCovariance stated = StatedCovariance(landmarks, patches, covariance);
  EXPECT_EQ(stated.covariance().topLeftCorner(2, 2), Eigen::Matrix2d::Identity());
  // Half of (2, 1) away from the anchor, which the parameters are about: 1 + 1^2 + 0.5^2.
  EXPECT_NEAR(stated.DistanceStddev(patches.back().centre, 2), 1.5, 1e-9);
}

}  // namespace
}  // namespace plumbline
