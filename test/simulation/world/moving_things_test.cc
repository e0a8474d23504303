#include "simulation/world/moving_things.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace plumbline {
namespace {

// From (2, 4) to (12, 4) at 1 m/s, 1.5 m above the floor.
Path Straight() {
  PathOptions options;
  options.way_points = {{{2, 4}, ""}, {{12, 4}, ""}};
  options.height_m = 1.5;
  return Path(options);
}

int64_t At(double seconds) { return static_cast<int64_t>(seconds * 1e9); }

TEST(MovingThings, PersonIsACylinder) {
  MovingOptions options;
  Person person;
  person.way_points = {{20, 4, 0}, {20, 4.001, 0}};  // all but stands
  options.people = {person};
  const MovingThings things(options, 1);
  const Path path = Straight();
  const auto cast = [&](const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
    return things.Cast(origin, direction.normalized(), path, At(1.0));
  };
  const std::optional<double> ahead = cast({3, 4, 1.5}, {1, 0, 0});
  ASSERT_TRUE(ahead);
  EXPECT_NEAR(*ahead, 17.0 - 0.2, 1e-4);
  EXPECT_FALSE(cast({3, 4, 1.5}, {-1, 0, 0}));
  EXPECT_FALSE(cast({3, 4.3, 1.5}, {1, 0, 0}));
  EXPECT_FALSE(cast({3, 4, 1.8}, {1, 0, 0}));  // over the head
  EXPECT_FALSE(cast({3, 4, 1.5}, {0, 0, -1}));
  const std::optional<double> head = cast({19, 4, 2.75}, {1, 0, -1});
  ASSERT_TRUE(head);
  EXPECT_NEAR(*head, std::sqrt(2.0), 1e-4);
  EXPECT_FALSE(cast({20, 4.1, 1.5}, {1, 0, 0}));  // from inside
}

TEST(MovingThings, PeopleWalkToAndFroAtTheirSpeed) {
  MovingOptions options;
  Person person;
  person.way_points = {{0, 0, 0}, {6, 0, 0}};
  person.speed_m_s = 1.2;
  options.people = {person};
  const MovingThings things(options, 3);
  const Path path = Straight();
  double low = 10.0, high = 0.0;
  for (double time = 0.0; time < 9.9; time += 0.1) {
    const Eigen::Vector3d a = things.PlaceOf(0, path, At(time));
    const Eigen::Vector3d b = things.PlaceOf(0, path, At(time + 0.01));
    low = std::min(low, a.x());
    high = std::max(high, a.x());
    EXPECT_LE((b - a).norm(), 0.012 + 1e-6);
  }
  EXPECT_LT(low, 0.2);
  EXPECT_GT(high, 5.8);
  // Another seed, another phase.
  EXPECT_GT((MovingThings(options, 4).PlaceOf(0, path, 0) - things.PlaceOf(0, path, 0)).norm(),
            1e-3);
}

TEST(MovingThings, FollowersAndCirclersStayWithTheRig) {
  MovingOptions options;
  options.people.resize(2);
  options.people[0].follows_m = 1.5;
  options.people[1].circles_m = 1.0;
  const MovingThings things(options, 1);
  const Path path = Straight();
  const Eigen::Vector3d rig(2 + 5, 4, 0);
  EXPECT_LT((things.PlaceOf(0, path, At(5)) - (rig - Eigen::Vector3d(1.5, 0, 0))).norm(),
            1e-9);
  EXPECT_NEAR((things.PlaceOf(1, path, At(5)) - rig).norm(), 1.0, 1e-9);
  // At the beginning the follower stands where the rig does, and steps aside.
  EXPECT_NEAR((things.PlaceOf(0, path, 0) - Eigen::Vector3d(2, 4, 0)).norm(), 0.6, 1e-9);
}

TEST(MovingThings, DoorsSwingAndOpenForTheRig) {
  MovingOptions options;
  Door door;
  door.hinge = {9, 4.5, 0};
  door.width_m = 1.0;
  door.shut_rad = -M_PI / 2;  // across the path
  door.open_rad = 0.0;
  door.period_s = 4.0;
  options.doors = {door};
  const MovingThings things(options, 2);
  const Path path = Straight();
  double low = 1.0, high = -2.0;
  for (double time = 0.0; time < 4.0; time += 0.05) {
    const double angle = things.AngleOf(0, path, At(time));
    low = std::min(low, angle);
    high = std::max(high, angle);
  }
  EXPECT_NEAR(low, -M_PI / 2, 1e-9);
  EXPECT_NEAR(high, 0.0, 1e-9);
  EXPECT_NEAR(things.AngleOf(0, path, At(7.0)), 0.0, 1e-9);  // the rig is there
  // Shut, it is a wall of its height.
  double shut_s = 0.0;
  while (things.AngleOf(0, path, At(shut_s)) > -M_PI / 2 + 1e-9) shut_s += 0.01;
  const auto cast = [&](double height) {
    return things.Cast({3, 4, height}, Eigen::Vector3d::UnitX(), path, At(shut_s));
  };
  ASSERT_TRUE(cast(1.5));
  EXPECT_NEAR(*cast(1.5), 6.0, 1e-9);
  EXPECT_FALSE(cast(2.1));
}

}  // namespace
}  // namespace plumbline
