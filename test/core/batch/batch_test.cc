#include "core/batch/batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "test/testing/room_walk.h"

namespace plumbline {
namespace {

// The state that following a walk leaves to the batch. The segments stay as they are found:
// the batch does not read the recording.
class BatchTest : public testing::Test {
 protected:
  BatchTest() {
    options_.batch.resegment = false;
    options_.association.surface_flatness_m = 1e-4;  // the room is even
  }

  void SetUp() override {
    ASSERT_TRUE(follower_.Start(walk_.Take()));
    for (int i = 0; i < 40; ++i) follower_.Follow(walk_.Take());
  }

  BatchReport Estimate() {
    return EstimateBatch(
        walk_.rig(),
        false,
        options_,
        [&](double share) { shares_.push_back(share); },
        nullptr,
        &state());
  }

  MapState& state() { return follower_.state(); }

  MapperOptions options_;
  RoomWalk walk_{Eigen::Vector3d(0.4, -0.3, 0.0)};
  ScanFollower follower_{walk_.rig(), false, options_, RoomWalk::kPeriod};
  std::vector<double> shares_;  // of the batch's time, as they are reported
};

TEST_F(BatchTest, PlanesAreWhereTheyAreAsPreciselyAsTheBatchSays) {
  const BatchReport report = Estimate();
  const Eigen::Quaterniond model_from_room = ModelFromRoom(state(), walk_.room());
  std::set<const ScenePlane*> found;
  size_t num_landmarks = 0;
  for (const Landmark& landmark : state().landmarks) {
    if (landmark.num_segments == 0) continue;
    ++num_landmarks;
    const ScenePlane* plane = PlaneOf(landmark, walk_.room(), model_from_room);
    ASSERT_NE(plane, nullptr) << "landmark " << landmark.id;
    found.insert(plane);  // parts of the floor that are far from each other stay apart
    // The body has moved from the room's origin before the model frame's is set.
    const double truth =
        plane->distance -
        plane->normal.dot(walk_.WorldFromBody(state().origin_time_ns).translation);
    const int row = landmark.num_parameters() - 1;
    EXPECT_LT(std::abs(landmark.Distance() - truth),
              RoomWalk::kMaxSigmas * std::sqrt(landmark.covariance(row, row)))
        << "landmark " << landmark.id;
    if (landmark.model != PlaneModel::kVertical) continue;
    const Eigen::Vector3d normal = model_from_room * plane->normal;
    const double turn = std::remainder(
        landmark.parameters[0] - std::atan2(normal.y(), normal.x()), 2.0 * M_PI);
    EXPECT_LE(std::abs(turn), RoomWalk::kMaxSigmas * std::sqrt(landmark.covariance(0, 0)))
        << "landmark " << landmark.id;
  }
  EXPECT_EQ(found.size(), walk_.room().size());
  EXPECT_EQ(report.covariance.landmark_ids().size(), num_landmarks);
}

TEST_F(BatchTest, VarianceFactorIsOneWhereTheNoiseIsAsStated) {
  const BatchReport report = Estimate();
  double num_points = 0.0;
  for (const Landmark& landmark : state().landmarks) {
    num_points += static_cast<double>(landmark.num_points);
  }
  // The spread of a sum of so many squares over their number.
  EXPECT_NEAR(report.variance_factor, 1.0, RoomWalk::kMaxSigmas * std::sqrt(2.0 / num_points));
}

TEST_F(BatchTest, EndsWhenAssociationsStand) {
  const BatchReport report = Estimate();
  EXPECT_LT(report.rounds, options_.batch.max_rounds);
  ASSERT_EQ(shares_.size(), static_cast<size_t>(report.rounds)) << "one report a round";
  EXPECT_TRUE(std::is_sorted(shares_.begin(), shares_.end()));
  EXPECT_GT(shares_.front(), 0.0);
  EXPECT_LT(shares_.back(), 1.0);
}

TEST_F(BatchTest, OneRoundIsEnoughWhereNoMoreAreAskedFor) {
  options_.batch.max_rounds = 1;
  EXPECT_EQ(Estimate().rounds, 1);
}

// The rounds undo wrong associations, and a plane that none of the observations support goes.
TEST_F(BatchTest, RoundsUndoWrongAssociations) {
  const size_t num_landmarks = state().landmarks.size();
  Landmark phantom = MakeVerticalLandmark({-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0});
  phantom.id = static_cast<int>(num_landmarks);
  phantom.covariance = Eigen::Vector3d(1e-4, 1e-4, 0.0).asDiagonal();
  state().landmarks.push_back(phantom);
  std::vector<size_t> moved;
  for (size_t i = 0; i < state().observations.size(); i += 50) {
    if (state().observations[i].landmark_id < 0) continue;
    moved.push_back(i);
    state().observations[i].landmark_id = phantom.id;
  }
  ASSERT_GT(moved.size(), 5U);
  const BatchReport report = Estimate();
  EXPECT_GT(report.rounds, 1);
  EXPECT_EQ(state().landmarks.back().num_segments, 0);
  for (const size_t i : moved) EXPECT_NE(state().observations[i].landmark_id, phantom.id);
}

TEST_F(BatchTest, CalmMotionIsFoundToBeCalm) {
  const BatchReport report = Estimate();
  // The rig moves straight on; the options allow for metres per second squared.
  EXPECT_LT(report.motion_noise.density[kHorizontal],
            0.5 * options_.trajectory.acceleration_density_m_s2);
  EXPECT_GT(report.motion_noise.density[kHorizontal], 0.0);
}

}  // namespace
}  // namespace plumbline
