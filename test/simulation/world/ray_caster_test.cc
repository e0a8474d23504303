#include "simulation/world/ray_caster.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/world/random.h"

namespace plumbline {
namespace {

// 6 x 4 m, 3 m high, a pillar from (2, 1) to (3, 2).
Building RoomWithPillar() {
  FloorPlan plan;
  plan.ceiling_height = 3.0;
  plan.outlines = {{{0, 0}, {6, 0}, {6, 4}, {0, 4}}};
  plan.solids = {{{2, 1}, {3, 1}, {3, 2}, {2, 2}}};
  return MakeBuilding(plan);
}

TEST(RayCaster, RangesComputedByHand) {
  const Building building = RoomWithPillar();
  const RayCaster caster(building);
  const Eigen::Vector3d origin(1.0, 1.5, 1.2);
  const auto range = [&](double x, double y, double z) {
    const std::optional<RayHit> hit =
        caster.Cast(origin, Eigen::Vector3d(x, y, z).normalized());
    return hit ? hit->range : -1.0;
  };
  EXPECT_NEAR(range(1, 0, 0), 1.0, 1e-12);  // pillar
  EXPECT_NEAR(range(-1, 0, 0), 1.0, 1e-12);
  EXPECT_NEAR(range(0, 1, 0), 2.5, 1e-12);
  EXPECT_NEAR(range(0, -1, 0), 1.5, 1e-12);
  EXPECT_NEAR(range(0, 0, -1), 1.2, 1e-12);
  EXPECT_NEAR(range(0, 0, 1), 1.8, 1e-12);
  EXPECT_NEAR(range(1, 1, 0), 2.5 * std::sqrt(2.0), 1e-12);  // past the pillar
  EXPECT_NEAR(range(1, 0, 2), std::sqrt(5.0) * 0.9, 1e-12);  // ceiling before the pillar
}

TEST(RayCaster, NamesTheFace) {
  const Building building = RoomWithPillar();
  const RayCaster caster(building);
  const std::optional<RayHit> hit = caster.Cast({1.0, 1.5, 1.2}, Eigen::Vector3d::UnitX());
  ASSERT_TRUE(hit);
  const Face& face = building.faces[static_cast<size_t>(hit->face_id)];
  EXPECT_LT((face.normal - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-12);
  EXPECT_NEAR(face.distance, -2.0, 1e-12);
}

TEST(RayCaster, NothingOutside) {
  const RayCaster caster(RoomWithPillar());
  EXPECT_FALSE(caster.Cast({10.0, 1.5, 1.2}, Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(caster.Cast({10.0, 1.5, 1.2}, -Eigen::Vector3d::UnitX()));
}

// Against all faces tested one by one, with rays in every direction: none slips through.
TEST(RayCaster, AgreesWithExhaustiveSearch) {
  const Building building = RoomWithPillar();
  const RayCaster caster(building);
  Random random({1});
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d origin(0.1 + 1.8 * random.Uniform(),
                                 0.1 + 3.8 * random.Uniform(),
                                 0.1 + 2.8 * random.Uniform());
    const Eigen::Vector3d direction =
        Eigen::Vector3d(random.Gaussian(), random.Gaussian(), random.Gaussian()).normalized();
    // The room is the outside of the pillar: enter it last, leave the box first.
    double leave = 1e9;
    double pillar_enter = 0.0;
    double pillar_leave = 1e9;
    const Eigen::Vector3d box(6, 4, 3), low(2, 1, 0), high(3, 2, 3);
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = [&](double wall) { return (wall - origin[axis]) / direction[axis]; };
      leave = std::min(leave, std::max(at(0), at(box[axis])));
      pillar_enter = std::max(pillar_enter, std::min(at(low[axis]), at(high[axis])));
      pillar_leave = std::min(pillar_leave, std::max(at(low[axis]), at(high[axis])));
    }
    const double expected = pillar_enter < pillar_leave ? pillar_enter : leave;
    const std::optional<RayHit> hit = caster.Cast(origin, direction);
    ASSERT_TRUE(hit);
    ASSERT_NEAR(hit->range, expected, 1e-9);
  }
}

// Rays at the common edges and corners of triangles meet one of them.
TEST(RayCaster, NoGapsAtEdges) {
  const Building building = RoomWithPillar();
  const RayCaster caster(building);
  const Eigen::Vector3d origin(1.0, 3.0, 1.0);
  for (const Face& face : building.faces) {
    for (const auto& [a, b, c] : face.triangles) {
      for (int i = 0; i <= 100; ++i) {
        const Eigen::Vector3d target = a + (b - a) * (i / 100.0);
        const Eigen::Vector3d direction = (target - origin).normalized();
        const std::optional<RayHit> hit = caster.Cast(origin, direction);
        ASSERT_TRUE(hit);
        ASSERT_LE(hit->range, (target - origin).norm() + 1e-6);
      }
    }
  }
}

TEST(RayCaster, ClearanceAndFreeSpace) {
  const RayCaster caster(RoomWithPillar());
  EXPECT_NEAR(caster.Clearance({1.0, 1.5, 1.2}), 1.0, 1e-12);
  EXPECT_NEAR(caster.Clearance({1.0, 1.5, 0.2}), 0.2, 1e-12);
  EXPECT_NEAR(caster.Clearance({1.7, 0.6, 1.5}), 0.5, 1e-12);  // the pillar's edge
  EXPECT_TRUE(caster.IsInFreeSpace({1.0, 1.5, 1.2}));
  EXPECT_FALSE(caster.IsInFreeSpace({2.5, 1.5, 1.2}));  // in the pillar
  EXPECT_FALSE(caster.IsInFreeSpace({7.0, 1.5, 1.2}));
  EXPECT_FALSE(caster.IsInFreeSpace({1.0, 1.5, 3.2}));  // in the ceiling
}

}  // namespace
}  // namespace plumbline
