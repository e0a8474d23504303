#include "core/following/tracker.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test/testing/known_room.h"

namespace plumbline {
namespace {

class TrackerTest : public testing::Test {
 protected:
  TrackerTest() { tracker_.Reset(RoomWalk::kStartNs, room_.Start()); }

  void Track(int num_scans) {
    for (int i = 0; i < num_scans; ++i) {
      const auto [first, last] = room_.Observe();
      tracker_.Track(
          first, last, {room_.state().landmarks, room_.scan_index(), options_.loop_closure});
      first_ = first;
    }
  }

  MapperOptions options_;
  KnownRoom room_{Eigen::Vector3d(0.4, -0.3, 0.0)};
  MotionPrior motion_prior_{options_.trajectory};
  Tracker tracker_{room_.rig(), false, options_, &motion_prior_, &room_.state()};
  int first_ = 0;  // observation of the last scan
};

// All but the segments whose direction is hardly known lie on one of the room's planes.
TEST_F(TrackerTest, FindsTheSegmentsPlanes) {
  Track(10);
  int num_found = 0, num_long = 0;
  for (size_t i = static_cast<size_t>(first_); i < room_.state().observations.size(); ++i) {
    const Observation& observation = room_.state().observations[i];
    if (observation.length_m() < 0.5) continue;
    ++num_long;
    if (observation.landmark_id >= 0) ++num_found;
  }
  EXPECT_GT(num_long, 5);
  EXPECT_EQ(num_found, num_long);
}

TEST_F(TrackerTest, FollowsAsPreciselyAsItSays) {
  Track(30);
  const int64_t now_ns = room_.end_ns();
  const Rigid3d pose = room_.state().trajectory.WorldFromBody(now_ns);
  const Matrix6d covariance = tracker_.pose_uncertainty().At(room_.state().trajectory, now_ns);
  const Eigen::Vector3d error =
      pose.translation - room_.walk().WorldFromBody(now_ns).translation;
  for (int axis = 0; axis < 3; ++axis) {
    const double sigma = std::sqrt(covariance(3 + axis, 3 + axis));
    EXPECT_LT(std::abs(error[axis]), RoomWalk::kMaxSigmas * sigma) << axis;
    EXPECT_LT(sigma, RoomWalk::kRangeNoise) << "many beams, one noise each";
  }
  EXPECT_TRUE(tracker_.IsSteady(now_ns));
}

// Planes are constant in the tracker's problem.
TEST_F(TrackerTest, LeavesThePlanesAlone) {
  const auto before = room_.state().landmarks[3].parameters;
  Track(5);
  EXPECT_EQ(room_.state().landmarks[3].parameters, before);
}

}  // namespace
}  // namespace plumbline
