#include "core/outputs/storey_levels.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

PlanePatch Level(int id, double direction, double z, double x_from, double x_to) {
  PlanePatch plane;
  plane.id = id;
  plane.type = PlaneType::kHorizontal;
  plane.normal = {0.0, 0.0, direction};
  plane.distance = direction * z;
  plane.centre = {0.5 * (x_from + x_to), 0.0, z};
  plane.num_points = 100;
  plane.outline = {{x_from, -1.0, z}, {x_to, -1.0, z}, {x_to, 1.0, z}, {x_from, 1.0, z}};
  return plane;
}

void Walk(const Eigen::Vector3d& from,
          const Eigen::Vector3d& to,
          std::vector<StampedPose>* poses) {
  for (int i = 0; i <= 20; ++i) {
    StampedPose& pose = poses->emplace_back();
    pose.world_from_body.translation = from + (to - from) * i / 20.0;
  }
}

// Two floors of 5 m, stairs with treads every 0.25 m between them.
std::vector<PlanePatch> TwoFloors() {
  std::vector<PlanePatch> planes = {Level(0, 1.0, 0.0, 0.0, 5.0),
                                    Level(1, 1.0, 3.0, 9.0, 14.0)};
  for (int i = 1; i < 12; ++i) {
    planes.push_back(Level(1 + i, 1.0, 0.25 * i, 5.0 + 0.33 * (i - 1), 5.0 + 0.33 * i));
  }
  return planes;
}

TEST(StoreyLevels, StairsAreNoStorey) {
  std::vector<StampedPose> poses;
  Walk({0.5, 0.0, 1.5}, {5.0, 0.0, 1.5}, &poses);
  Walk({5.0, 0.0, 1.5}, {9.0, 0.0, 4.5}, &poses);
  Walk({9.0, 0.0, 4.5}, {13.0, 0.0, 4.5}, &poses);
  const std::vector<StoreyLevel> storeys = FindStoreys(TwoFloors(), poses, {});
  ASSERT_EQ(storeys.size(), 2u);
  EXPECT_DOUBLE_EQ(storeys[0].floor_m, 0.0);
  EXPECT_DOUBLE_EQ(storeys[1].floor_m, 3.0);
  EXPECT_FALSE(storeys[0].has_ceiling);
  EXPECT_DOUBLE_EQ(storeys[0].top_m, 2.5);
}

// Points all over a level or sloping surface.
void Cover(const PlanePatch& plane, std::vector<CloudPoint>* points) {
  for (double x = plane.outline[0].x(); x <= plane.outline[1].x(); x += 0.1) {
    for (double y = -1.0; y <= 1.0; y += 0.1) {
      CloudPoint& point = points->emplace_back();
      point.plane_id = plane.id;
      point.p_world = Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), 0.0f);
    }
  }
}

TEST(StoreyLevels, FloorsThatMeetByAStepAreOneStorey) {
  std::vector<PlanePatch> planes = {Level(0, 1.0, 0.0, 0.0, 5.0),
                                    Level(1, 1.0, 0.6, 5.0, 9.0),
                                    Level(2, -1.0, 2.6, 0.0, 5.0),
                                    Level(3, -1.0, 3.4, 5.0, 9.0),
                                    Level(4, 1.0, 0.7, 1.0, 4.0)};  // a table beside the way
  std::vector<StampedPose> poses;
  Walk({4.5, 0.0, 1.5}, {0.0, 0.0, 1.5}, &poses);
  Walk({0.0, 0.0, 1.5}, {4.9, 0.0, 1.5}, &poses);
  Walk({5.0, 0.0, 2.1}, {9.0, 0.0, 2.1}, &poses);
  std::vector<CloudPoint> points;
  for (const PlanePatch& plane : planes) Cover(plane, &points);
  // The table stands where the rig did not go, but near.
  for (Eigen::Vector3d& corner : planes[4].outline) corner.y() += 1.8;
  const std::vector<StoreyLevel> storeys = FindStoreys(planes, poses, points);
  ASSERT_EQ(storeys.size(), 1u);
  EXPECT_DOUBLE_EQ(storeys[0].floor_m, 0.0);
  EXPECT_DOUBLE_EQ(storeys[0].At({2.0, 0.0}).floor_m, 0.0);
  EXPECT_DOUBLE_EQ(storeys[0].At({2.0, 0.0}).top_m, 2.6);
  EXPECT_DOUBLE_EQ(storeys[0].At({7.0, 0.0}).floor_m, 0.6);
  EXPECT_DOUBLE_EQ(storeys[0].At({7.0, 0.0}).top_m, 3.4);
  EXPECT_DOUBLE_EQ(storeys[0].At({20.0, 5.0}).floor_m, 0.6);  // the nearest
}

TEST(StoreyLevels, HalfStoreysAboveEachOtherAreTwo) {
  const std::vector<PlanePatch> planes = {Level(0, 1.0, 0.0, 0.0, 4.0),
                                          Level(1, 1.0, 1.4, 4.0, 10.0),
                                          Level(2, 1.0, 2.9, 0.0, 4.0)};
  std::vector<StampedPose> poses;
  Walk({3.5, 0.0, 1.5}, {0.0, 0.0, 1.5}, &poses);
  Walk({0.0, 0.0, 1.5}, {3.9, 0.0, 1.5}, &poses);
  Walk({4.0, 0.0, 2.9}, {10.0, 0.0, 2.9}, &poses);
  Walk({3.9, 0.0, 4.4}, {0.1, 0.0, 4.4}, &poses);
  std::vector<CloudPoint> points;
  for (const PlanePatch& plane : planes) Cover(plane, &points);
  const std::vector<StoreyLevel> storeys = FindStoreys(planes, poses, points);
  ASSERT_EQ(storeys.size(), 2u);
  EXPECT_DOUBLE_EQ(storeys[0].At({2.0, 0.0}).floor_m, 0.0);
  EXPECT_DOUBLE_EQ(storeys[0].At({7.0, 0.0}).floor_m, 1.4);
  EXPECT_DOUBLE_EQ(storeys[1].floor_m, 2.9);
}

TEST(StoreyLevels, ACeilingEndsAStorey) {
  std::vector<StampedPose> poses;
  Walk({0.5, 0.0, 1.5}, {5.0, 0.0, 1.5}, &poses);
  std::vector<PlanePatch> planes = TwoFloors();
  planes.push_back(Level(50, -1.0, 2.7, 0.0, 5.0));
  planes.push_back(Level(51, -1.0, 0.7, 0.0, 5.0));  // below a table
  const std::vector<StoreyLevel> storeys = FindStoreys(planes, poses, {});
  ASSERT_EQ(storeys.size(), 1u);
  EXPECT_TRUE(storeys[0].has_ceiling);
  EXPECT_DOUBLE_EQ(storeys[0].top_m, 2.7);
}

TEST(StoreyLevels, APlanarMapIsOneStorey) {
  std::vector<StampedPose> poses;
  Walk({0.5, 0.0, 0.0}, {5.0, 0.0, 0.0}, &poses);
  const std::vector<StoreyLevel> storeys = FindStoreys({}, poses, {});
  ASSERT_EQ(storeys.size(), 1u);
  EXPECT_FALSE(storeys[0].has_floor);
  EXPECT_LT(storeys[0].band_low_m(), 0.0);
  EXPECT_GT(storeys[0].band_high_m(), 0.0);
}

TEST(CoversInPlan, InsideNearAndFar) {
  const PlanePatch plane = Level(0, 1.0, 0.0, 0.0, 5.0);
  EXPECT_TRUE(CoversInPlan(plane.outline, {2.0, 0.0}, 0.0));
  EXPECT_FALSE(CoversInPlan(plane.outline, {5.2, 0.0}, 0.1));
  EXPECT_TRUE(CoversInPlan(plane.outline, {5.2, 0.0}, 0.3));
}

}  // namespace
}  // namespace plumbline
