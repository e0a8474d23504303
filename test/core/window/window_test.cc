#include "core/window/window.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/following/tracker.h"
#include "test/testing/known_room.h"

namespace plumbline {
namespace {

constexpr double kWindowS = 0.25;

class WindowTest : public testing::Test {
 protected:
  WindowTest() { tracker_.Reset(RoomWalk::kStartNs, room_.Start()); }

  // Tracks scans, and solves the window after every fifth, the default knot interval.
  void Follow(int num_scans) {
    for (int i = 0; i < num_scans; ++i) {
      const auto [first, last] = room_.Observe();
      tracker_.Track(
          first, last, {room_.state().landmarks, room_.scan_index(), options_.loop_closure});
      for (int index = first; index <= last; ++index) {
        if (room_.state().observations[static_cast<size_t>(index)].landmark_id >= 0) {
          window_.Add(index);
        }
      }
      if (room_.scan_index() % 5 != 4) continue;
      tracker_.Reset(room_.end_ns(), window_.Solve(room_.end_ns(), kWindowS));
    }
  }
  double SigmaOfDistance(size_t landmark) {
    const Landmark& wall = room_.state().landmarks[landmark];
    return std::sqrt(wall.covariance(wall.num_parameters() - 1, wall.num_parameters() - 1));
  }

  MapperOptions options_;
  KnownRoom room_{Eigen::Vector3d(0.4, -0.3, 0.0)};
  MotionPrior motion_prior_{options_.trajectory};
  Tracker tracker_{room_.rig(), false, options_, &motion_prior_, &room_.state()};
  Window window_{room_.rig(), false, options_, &motion_prior_, &room_.state()};
};

// The window holds a quarter of a second; what has left it still counts, by the marginal
// prior.
TEST_F(WindowTest, RemembersWhatHasLeftIt) {
  Follow(10);
  const double young = SigmaOfDistance(2);
  Follow(40);
  EXPECT_LT(SigmaOfDistance(2), 0.8 * young);
}

TEST_F(WindowTest, ReturnsTheNewestControlPoints) {
  Follow(9);
  const auto [first, last] = room_.Observe();
  tracker_.Track(
      first, last, {room_.state().landmarks, room_.scan_index(), options_.loop_closure});
  for (int index = first; index <= last; ++index) {
    if (room_.state().observations[static_cast<size_t>(index)].landmark_id >= 0) {
      window_.Add(index);
    }
  }
  const PoseGaussian newest = window_.Solve(room_.end_ns(), kWindowS);
  EXPECT_EQ(newest.first, room_.state().trajectory.Locate(room_.end_ns()).first);
  EXPECT_EQ(newest.end(), room_.state().trajectory.num_control_points());
  EXPECT_EQ(newest.information.rows(), 6 * static_cast<Eigen::Index>(newest.mean.size()));
}

}  // namespace
}  // namespace plumbline
