#include "simulation/world/furniture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/world/building.h"
#include "simulation/world/ray_caster.h"

namespace plumbline {
namespace {

Building Room(const Furniture& piece) {
  FloorPlan plan;
  plan.floor_height = 1.0;
  plan.ceiling_height = 4.0;
  plan.outlines = {{{0, 0}, {8, 0}, {8, 6}, {0, 6}}};
  plan.furniture = {piece};
  return MakeBuilding(plan);
}

double Range(const Building& building,
             const Eigen::Vector3d& origin,
             const Eigen::Vector3d& direction) {
  return RayCaster(building).Cast(origin, direction)->range;
}

TEST(Furniture, BoxHidesWhatIsBehind) {
  const Building building =
      Room({Furniture::Kind::kBox, {4, 3}, {2, 1, 0.8}, M_PI / 2, 0.0, false});
  ASSERT_EQ(building.faces.size(), 12u);
  for (const Face& face : building.faces) {
    EXPECT_EQ(face.id, &face - building.faces.data());
    // Counter-clockwise from outside.
    const Eigen::Vector3d cross = (face.triangles[0][1] - face.triangles[0][0])
                                      .cross(face.triangles[0][2] - face.triangles[0][0]);
    EXPECT_GT(cross.normalized().dot(face.normal), 0.999);
    for (const Eigen::Vector3d& corner : face.outline) {
      EXPECT_NEAR(face.normal.dot(corner), face.distance, 1e-12);
    }
  }
  // Turned by 90 degrees it is 1 m along x.
  EXPECT_NEAR(Range(building, {1, 3, 1.5}, {1, 0, 0}), 2.5, 1e-12);
  EXPECT_NEAR(Range(building, {1, 3, 1.9}, {1, 0, 0}), 7.0, 1e-12);
  EXPECT_NEAR(Range(building, {4, 3, 3}, {0, 0, -1}), 1.2, 1e-12);
}

TEST(Furniture, TablesStandOnLegs) {
  const Building building =
      Room({Furniture::Kind::kTable, {4, 3}, {2, 1, 0.75}, 0.0, 0.0, false});
  EXPECT_EQ(building.faces.size(), 6u + 5 * 6u);
  EXPECT_NEAR(Range(building, {4, 1, 1.5}, {0, 1, 0}), 5.0, 1e-12);     // between the legs
  EXPECT_NEAR(Range(building, {3.02, 1, 1.5}, {0, 1, 0}), 1.5, 1e-12);  // a leg
  EXPECT_NEAR(Range(building, {4, 1, 1.73}, {0, 1, 0}), 1.5, 1e-12);    // the board's edge
}

TEST(Furniture, ShelvesAreOpenBetweenTheirBoards) {
  const Building building =
      Room({Furniture::Kind::kShelf, {4, 3}, {2, 0.4, 2.0}, 0.0, 0.0, false});
  EXPECT_EQ(building.faces.size(), 6u + (2 + 6) * 6u);
  EXPECT_NEAR(Range(building, {4, 1, 1.2}, {0, 1, 0}), 5.0, 1e-12);
  EXPECT_NEAR(Range(building, {4, 1, 2.985}, {0, 1, 0}), 1.8, 1e-12);  // the top board
}

TEST(Furniture, GlassIsMarked) {
  const Building building =
      Room({Furniture::Kind::kBox, {4, 3}, {2, 0.01, 2}, 0.0, 0.0, true});
  const RayCaster caster(building);
  EXPECT_TRUE(caster.Cast({4, 1, 2}, {0, 1, 0})->is_glass);
  EXPECT_NEAR(caster.Cast({4, 1, 2}, {0, 1, 0}, true)->range, 5.0, 1e-12);
}

}  // namespace
}  // namespace plumbline
