#include "core/map/map_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "test/testing/known_room.h"

namespace plumbline {
namespace {

class MapFrameTest : public testing::Test {
 protected:
  MapFrameTest() {
    for (int scan = 0; scan < 3; ++scan) room_.Observe();
  }

  MapState& state() { return room_.state(); }

  // The distance of the first pose from each landmark, by id.
  std::vector<double> DistancesOfStart() {
    std::vector<double> distances;
    const Eigen::Vector3d start =
        state().trajectory.WorldFromBody(state().trajectory.start_ns()).translation;
    for (const Landmark& landmark : state().landmarks) {
      distances.push_back(landmark.SignedDistance(start));
    }
    return distances;
  }

  KnownRoom room_{Eigen::Vector3d(0.4, -0.3, 0.0)};
};

TEST_F(MapFrameTest, XBecomesTheNormalOfTheWallThatIsSeenMost) {
  size_t wall = state().landmarks.size() - 1;  // the last one
  while (state().landmarks[wall].model != PlaneModel::kVertical) --wall;
  ASSERT_GT(wall, 0u);
  state().landmarks.front().heading_fixed = false;
  int num_on_wall = 0;
  for (size_t i = 0; i < state().observations.size(); ++i) {
    state().observations[i].landmark_id = i % 3 == 0 ? 0 : static_cast<int>(wall);
    num_on_wall += i % 3 == 0 ? 0 : 1;
  }
  const std::vector<double> before = DistancesOfStart();
  const Eigen::Vector3d normal = state().landmarks[wall].Normal();
  const Eigen::Vector3d other = state().landmarks[0].Normal();
  TurnToWall(room_.rig(), &state());
  const Landmark& first = state().landmarks.front();
  EXPECT_EQ(first.Normal(), Eigen::Vector3d::UnitX());
  EXPECT_TRUE(first.heading_fixed);
  EXPECT_EQ(first.num_segments, num_on_wall);
  const Landmark& swapped = state().landmarks[wall];
  EXPECT_FALSE(swapped.heading_fixed);
  EXPECT_NEAR(swapped.Normal().dot(first.Normal()), other.dot(normal), 1e-12);
  for (size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(state().landmarks[i].id, static_cast<int>(i));
  }
  const std::vector<double> after = DistancesOfStart();
  EXPECT_NEAR(after[0], before[wall], 1e-12);
  EXPECT_NEAR(after[wall], before[0], 1e-12);
}

TEST_F(MapFrameTest, WithoutAWallTheMapStaysAsItIs) {
  state().landmarks.front().heading_fixed = false;
  const Eigen::Vector3d normal = state().landmarks.front().Normal();
  TurnToWall(room_.rig(), &state());
  EXPECT_EQ(state().landmarks.front().Normal(), normal);
  EXPECT_FALSE(state().landmarks.front().heading_fixed);
}

TEST_F(MapFrameTest, AMapMovesWithAllThatItHolds) {
  const std::vector<double> before = DistancesOfStart();
  const Rigid3d to_from(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ())),
                        {3.0, -1.0, 0.5});
  state().pose_constraints.emplace_back();
  MoveMap(room_.rig(), to_from, &state());
  const std::vector<double> after = DistancesOfStart();
  for (size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(after[i], before[i], 1e-12);
  EXPECT_TRUE(state().pose_constraints.empty());
}

}  // namespace
}  // namespace plumbline
