#include "core/result/result_types.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

// A cylinder of 2 m about the z axis, seen from one side (facing 1: from outside) at (2, 0,
// 1).
PlanePatch Round(double facing) {
  PlanePatch patch;
  patch.type = PlaneType::kCylinder;
  patch.centre = {2.0, 0.0, 1.0};
  patch.normal = {facing, 0.0, 0.0};
  patch.distance = patch.normal.dot(patch.centre);
  patch.curvature = facing / 2.0;
  return patch;
}

TEST(PlanePatch, IsFlatWithoutCurvature) {
  PlanePatch wall;
  wall.normal = {0.0, 1.0, 0.0};
  wall.distance = 3.0;
  EXPECT_FALSE(wall.IsCurved());
  EXPECT_EQ(wall.NormalAt({7.0, 3.0, 1.0}), wall.normal);
  EXPECT_DOUBLE_EQ(wall.SignedDistance({7.0, 3.5, 1.0}), 0.5);
}

TEST(PlanePatch, KnowsTheAxisOfACylinder) {
  for (const double facing : {1.0, -1.0}) {
    EXPECT_DOUBLE_EQ(Round(facing).Radius(), 2.0);
    EXPECT_LT((Round(facing).AxisPoint() - Eigen::Vector3d(0.0, 0.0, 1.0)).norm(), 1e-12);
  }
}

// Of a half circle's chord half the disc; a bay adds to the room before it, a column takes
// away.
TEST(PlanePatch, KnowsTheAreaBehindAChord) {
  EXPECT_NEAR(Round(-1.0).AreaBehindChord(4.0), 2.0 * M_PI, 1e-9);
  EXPECT_NEAR(Round(1.0).AreaBehindChord(4.0), -2.0 * M_PI, 1e-9);
  EXPECT_NEAR(Round(-1.0).AreaBehindChord(2.0 * std::sqrt(2.0)), M_PI - 2.0, 1e-12);
  EXPECT_EQ(PlanePatch().AreaBehindChord(4.0), 0.0);
}

// Distances are positive on the side that was seen, and normals point there.
TEST(PlanePatch, FacesTheSideThatWasSeenAllRound) {
  for (const double facing : {1.0, -1.0}) {
    const PlanePatch patch = Round(facing);
    for (const double angle : {0.0, 1.0, 2.5, -3.0}) {
      const Eigen::Vector3d outwards(std::cos(angle), std::sin(angle), 0.0);
      const Eigen::Vector3d above(0.0, 0.0, 5.0);
      EXPECT_LT((patch.NormalAt(2.0 * outwards + above) - facing * outwards).norm(), 1e-12);
      EXPECT_NEAR(patch.SignedDistance(2.3 * outwards + above), facing * 0.3, 1e-12);
      EXPECT_NEAR(patch.SignedDistance(1.6 * outwards + above), -facing * 0.4, 1e-12);
    }
  }
}

// A wall that hardly bends is as far as the plane that it bends from.
TEST(PlanePatch, BendsWithoutAStep) {
  PlanePatch wall;
  wall.normal = {0.0, 1.0, 0.0};
  wall.distance = 3.0;
  wall.centre = {7.0, 3.0, 1.0};
  const Eigen::Vector3d p(9.0, 3.5, 4.0);
  for (const double curvature : {1e-12, -1e-12}) {
    wall.curvature = curvature;
    EXPECT_NEAR(wall.SignedDistance(p), 0.5, 1e-11);
    EXPECT_LT((wall.NormalAt(p) - wall.normal).norm(), 1e-11);
  }
}

TEST(FieldsOf, TurnsAreAmongTheParameters) {
  for (const PlaneType type : {PlaneType::kHorizontal,
                               PlaneType::kVertical,
                               PlaneType::kGeneral,
                               PlaneType::kCylinder}) {
    const PlaneTypeFields& fields = FieldsOf(type);
    EXPECT_LT(fields.num_turns, static_cast<int>(fields.parameters.size())) << fields.name;
  }
  EXPECT_EQ(FieldsOf(PlaneType::kCylinder).name, "cylinder");
  EXPECT_TRUE(FieldsOf(PlaneType::kCylinder).has_radius);
}

}  // namespace
}  // namespace plumbline
