// Following a rig by its wheels where the scans show nothing.

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/following/scan_follower.h"
#include "core/sensor/odometry.h"
#include "core/util/time.h"
#include "test/testing/room_walk.h"

namespace plumbline {
namespace {

// A rig walks on, and stops as soon as its scanners are covered.
class OdometryFollowingTest : public testing::Test {
 protected:
  static constexpr double kSpeed = 0.5;   // m/s, of either axis
  static constexpr int kNumSeeing = 120;  // scans, 3 s
  static constexpr int kNumBlind = 20;    // 0.5 s

  OdometryFollowingTest() { options_.association.surface_flatness_m = 1e-4; }

  // What wheels say that count `scale` metres where the rig goes one.
  std::shared_ptr<const Odometry> Wheels(double scale) const {
    RoomWalk walk = walk_;
    for (int i = 0; i < kNumSeeing; ++i) walk.Take();
    walk.Stop();
    std::vector<OdometrySample> samples;
    const int64_t period_ns = NanosecondsFromSeconds(0.02);
    for (int64_t t = RoomWalk::kStartNs - period_ns;
         t < walk.now_ns() + NanosecondsFromSeconds(2.0);
         t += period_ns) {
      samples.push_back({t, scale * walk.WorldFromBody(t).translation.head<2>(), 0.0});
    }
    return std::make_shared<const Odometry>(samples);
  }

  // How far off the rig is believed to be after the walk.
  double ErrorWith(std::shared_ptr<const Odometry> wheels) {
    RoomWalk walk = walk_;
    follower_ = std::make_unique<ScanFollower>(
        walk.rig(), false, options_, RoomWalk::kPeriod, std::move(wheels));
    EXPECT_TRUE(follower_->Start(walk.Take()));
    for (int i = 1; i < kNumSeeing; ++i) follower_->Follow(walk.Take());
    walk.Stop();
    for (int i = 0; i < kNumBlind; ++i) follower_->Follow(walk.TakeBlind());
    const MapState& state = follower_->state();
    const int64_t now_ns = follower_->scan_times_ns().back();
    const Eigen::Vector3d way = walk.WorldFromBody(now_ns).translation -
                                walk.WorldFromBody(state.origin_time_ns).translation;
    const Eigen::Vector3d truth = ModelFromRoom(state, walk.room()) * way;
    return (state.trajectory.WorldFromBody(now_ns).translation - truth).norm();
  }

  MapperOptions options_;
  RoomWalk walk_{Eigen::Vector3d(kSpeed, -kSpeed, 0.0)};
  std::unique_ptr<ScanFollower> follower_;
};

TEST_F(OdometryFollowingTest, WheelsSayThatTheRigHasStopped) {
  // Without wheels it is believed to have gone on for half a second.
  EXPECT_GT(ErrorWith(nullptr), 0.2);
  EXPECT_LT(ErrorWith(Wheels(1.0)), 0.05);
}

TEST_F(OdometryFollowingTest, TheScaleOfTheWheelsIsFound) {
  ErrorWith(Wheels(1.05));
  const OdometryCalibration& calibration = follower_->state().odometry_calibration;
  EXPECT_GT(calibration.num_motions(), 10);
  EXPECT_NEAR(calibration.length_scale(), 1.0 / 1.05, 0.015);
}

}  // namespace
}  // namespace plumbline
