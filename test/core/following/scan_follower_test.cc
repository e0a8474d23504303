#include "core/following/scan_follower.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/estimation/imu_terms.h"
#include "core/following/scan_on_planes.h"
#include "test/testing/room_walk.h"
#include "test/testing/test_files.h"

namespace plumbline {
namespace {

constexpr double kDegree = M_PI / 180.0;

class ScanFollowerTest : public testing::Test {
 protected:
  ScanFollowerTest() { options_.association.surface_flatness_m = 1e-4; }  // the room is even

  // Follows the walk from its next scan on, which has to be good for a start.
  void Start(int num_more_scans) {
    ASSERT_TRUE(follower_.Start(walk_.Take()));
    Follow(num_more_scans);
  }
  void Follow(int num_scans) {
    for (int i = 0; i < num_scans; ++i) follower_.Follow(walk_.Take());
  }

  int NumLandmarks() { return static_cast<int>(follower_.state().landmarks.size()); }

  MapperOptions options_;
  RoomWalk walk_{Eigen::Vector3d(0.4, -0.3, 0.0)};
  ScanFollower follower_{walk_.rig(), false, options_, RoomWalk::kPeriod};
};

TEST_F(ScanFollowerTest, StartsWithTheFirstScanThatShowsTheModelFrame) {
  EXPECT_FALSE(follower_.Start(walk_.TakeBlind()));
  EXPECT_FALSE(follower_.started());
  ASSERT_TRUE(follower_.Start(walk_.Take()));
  EXPECT_TRUE(follower_.started());
  EXPECT_EQ(follower_.scan_times_ns().size(), 1U);
  // The model frame: x is the normal of the first wall, z points up.
  const MapState& state = follower_.state();
  EXPECT_TRUE(state.landmarks.front().heading_fixed);
  EXPECT_EQ(state.landmarks.front().Normal(), Eigen::Vector3d::UnitX());
  const Eigen::Quaterniond model_from_room = ModelFromRoom(state, walk_.room());
  std::set<const ScenePlane*> found;
  for (const Landmark& landmark : state.landmarks) {
    const ScenePlane* plane = PlaneOf(landmark, walk_.room(), model_from_room);
    EXPECT_NE(plane, nullptr) << "landmark " << landmark.id;
    EXPECT_TRUE(found.insert(plane).second) << "landmark " << landmark.id << " stands twice";
  }
}

TEST_F(ScanFollowerTest, FollowsAStraightMotionAsPreciselyAsItSays) {
  options_.window.keep_estimates = true;
  Start(40);
  const MapState& state = follower_.state();
  const Eigen::Quaterniond model_from_room = ModelFromRoom(state, walk_.room());
  ASSERT_FALSE(follower_.estimates().empty());
  for (const WindowEstimate& estimate : follower_.estimates()) {
    const StampedPose& pose = estimate.newest_pose;
    const Eigen::Vector3d truth =
        model_from_room * (walk_.WorldFromBody(pose.time_ns).translation -
                           walk_.WorldFromBody(state.origin_time_ns).translation);
    const Eigen::Vector3d position_error = pose.world_from_body.translation - truth;
    const Eigen::AngleAxisd turn(pose.world_from_body.rotation * model_from_room.conjugate());
    const Eigen::Vector3d rotation_error = turn.angle() * turn.axis();
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LT(std::abs(rotation_error[axis]),
                RoomWalk::kMaxSigmas * std::sqrt(estimate.pose_covariance(axis, axis)));
      EXPECT_LT(
          std::abs(position_error[axis]),
          RoomWalk::kMaxSigmas * std::sqrt(estimate.pose_covariance(3 + axis, 3 + axis)));
    }
  }
  // The last pose is known at least as well as the nearest few beams alone would tell it.
  const Matrix6d& covariance = follower_.estimates().back().pose_covariance;
  EXPECT_LT(std::sqrt(covariance.bottomRightCorner<3, 3>().trace()), RoomWalk::kRangeNoise);
}

// The accelerometer is 2 degrees off upright; nothing but the scans then shows the vertical.
TEST_F(ScanFollowerTest, StartsByGravityWithoutAModelFrame) {
  constexpr int64_t kStep = 5'000'000;  // ns
  Rig rig = walk_.rig();
  rig.imu.emplace();
  rig.imu->gyroscope.noise = 1e-3;
  rig.imu->accelerometer.noise = 0.01;
  rig.imu->accelerometer.bias = 0.5;
  std::vector<ImuSample> samples;
  for (int i = 0; i < 600; ++i) {
    samples.push_back({RoomWalk::kStartNs + i * kStep,
                       Eigen::Vector3d::Zero(),
                       {kStandardGravity * std::sin(2.0 * kDegree), 0.0, kStandardGravity}});
  }
  const MapperOptions options = WithoutMotionPrior(options_);
  ScanFollower follower(rig,
                        false,
                        options,
                        RoomWalk::kPeriod,
                        nullptr,
                        std::make_shared<const ImuReadings>(samples, *rig.imu));
  EXPECT_FALSE(follower_.StartByGravity(walk_.Take())) << "no IMU";
  EXPECT_FALSE(follower.StartByGravity(walk_.TakeBlind()));
  ASSERT_TRUE(follower.StartByGravity(walk_.Take()));
  const MapState& state = follower.state();
  EXPECT_TRUE(state.landmarks.empty()) << "one scan founds no plane";
  for (int i = 0; i < 60; ++i) follower.Follow(walk_.Take());
  follower.FaceWall();
  EXPECT_TRUE(state.landmarks.front().heading_fixed);
  EXPECT_EQ(state.landmarks.front().Normal(), Eigen::Vector3d::UnitX());
  const Eigen::Quaterniond model_from_room = ModelFromRoom(state, walk_.room());
  std::set<const ScenePlane*> found;
  for (const Landmark& landmark : state.landmarks) {
    if (landmark.num_segments == 0) continue;
    const ScenePlane* plane = PlaneOf(landmark, walk_.room(), model_from_room);
    EXPECT_NE(plane, nullptr) << "landmark " << landmark.id;
    found.insert(plane);
  }
  EXPECT_EQ(found.size(), walk_.room().size());
  const int64_t now_ns = follower.scan_times_ns().back();
  const Rigid3d end = state.trajectory.WorldFromBody(now_ns);
  const Eigen::Vector3d way = walk_.WorldFromBody(now_ns).translation -
                              walk_.WorldFromBody(state.origin_time_ns).translation;
  EXPECT_LT((end.translation - model_from_room * way).norm(), RoomWalk::kRangeNoise);
  EXPECT_LT(end.rotation.angularDistance(model_from_room), 0.1 * kDegree);
}

// The copy linearises its segments anew, so that both agree to less than the last digit.
TEST_F(ScanFollowerTest, ACopyGoesOnByItself) {
  constexpr double kSame = 1e-5;  // m
  Start(20);
  ScanFollower copy(follower_);
  RoomWalk walk = walk_;
  for (int i = 0; i < 20; ++i) copy.Follow(walk.Take());
  const int64_t copied_ns = copy.state().trajectory.end_ns() - 1;
  ASSERT_LT(follower_.state().trajectory.end_ns(), copied_ns) << "the copy moved the original";
  Follow(20);
  const Eigen::Vector3d original =
      follower_.state().trajectory.WorldFromBody(copied_ns).translation;
  EXPECT_LT((copy.state().trajectory.WorldFromBody(copied_ns).translation - original).norm(),
            kSame);
  EXPECT_EQ(copy.state().observations.size(), follower_.state().observations.size());
  EXPECT_EQ(copy.state().landmarks.size(), follower_.state().landmarks.size());
}

// All walls go along with the rig, as people do. None of them counts as long.
TEST_F(ScanFollowerTest, TheMotionBridgesWhatGoesAlongWithTheRig) {
  constexpr int kNumScans = 20;
  Start(40);
  const Eigen::Quaterniond model_from_room = ModelFromRoom(follower_.state(), walk_.room());
  const auto error_of = [&](const ScanFollower& follower) {
    const MapState& state = follower.state();
    const int64_t now_ns = follower.scan_times_ns().back();
    const Eigen::Vector3d way = walk_.WorldFromBody(now_ns).translation -
                                walk_.WorldFromBody(state.origin_time_ns).translation;
    return (state.trajectory.WorldFromBody(now_ns).translation - model_from_room * way).norm();
  };
  ScanFollower bridging(follower_);
  for (Landmark& landmark : bridging.state().landmarks) {
    if (landmark.model == PlaneModel::kVertical) landmark.extent = landmark.EmptyExtent();
  }
  bridging.BridgeByMotion(bridging.scan_times_ns().back());
  const size_t num_landmarks = bridging.state().landmarks.size();
  const Eigen::Vector3d step =
      walk_.WorldFromBody(RoomWalk::kStartNs + 25'000'000).translation;
  for (int i = 0; i < kNumScans; ++i) {
    for (ScenePlane& plane : walk_.room()) plane.distance += plane.normal.dot(step);
    const Scan scan = walk_.Take();
    bridging.Follow(scan);
    follower_.Follow(scan);
  }
  EXPECT_TRUE(bridging.is_open());
  EXPECT_EQ(bridging.state().landmarks.size(), num_landmarks);
  // White accelerations at the knots: what their integral lets expect, in two directions.
  const double duration_s = kNumScans * RoomWalk::kPeriod;
  const double sigma_m = options_.trajectory.bridging_acceleration_density_m_s2 *
                         std::sqrt(2.0 / 3.0) * std::pow(duration_s, 1.5);
  EXPECT_LT(error_of(bridging), 3.0 * sigma_m);
  EXPECT_GT(error_of(follower_), 0.9 * kNumScans * step.norm());
}

TEST_F(ScanFollowerTest, FindsThePlanesOfTheRoomAndNoOthers) {
  Start(40);
  const Eigen::Quaterniond model_from_room = ModelFromRoom(follower_.state(), walk_.room());
  std::set<const ScenePlane*> found;
  for (const Landmark& landmark : follower_.state().landmarks) {
    if (landmark.num_segments == 0) continue;  // merged into another
    const ScenePlane* plane = PlaneOf(landmark, walk_.room(), model_from_room);
    EXPECT_NE(plane, nullptr) << "landmark " << landmark.id;
    found.insert(plane);  // parts of the floor that are far from each other stay apart
  }
  EXPECT_EQ(found.size(), walk_.room().size());
}

TEST_F(ScanFollowerTest, FoundsAPlaneInTheScanThatConfirmsItOftenEnough) {
  Start(10);
  const int before = NumLandmarks();
  // A wall closes off a corner, out of reach of the other planes' tests.
  walk_.room().push_back({{std::cos(30.0 * kDegree), std::sin(30.0 * kDegree), 0.0}, -2.0});
  Follow(options_.planes.min_scans - 1);
  EXPECT_EQ(NumLandmarks(), before);
  Follow(1);
  ASSERT_EQ(NumLandmarks(), before + 1);
  const Landmark& landmark = follower_.state().landmarks.back();
  EXPECT_EQ(PlaneOf(landmark, walk_.room(), ModelFromRoom(follower_.state(), walk_.room())),
            &walk_.room().back());
  EXPECT_GE(landmark.num_segments, options_.planes.min_scans);
}

// Nearer than five range noises to a wall that has been seen there, a plane can not be another
// surface; ten range noises away it can.
TEST_F(ScanFollowerTest, DoesNotFoundARedundantPlane) {
  for (const double range_noises : {3.5, 10.0}) {
    RoomWalk walk;
    ScanFollower follower(walk.rig(), false, options_, RoomWalk::kPeriod);
    ASSERT_TRUE(follower.Start(walk.Take()));
    for (int i = 0; i < 10; ++i) follower.Follow(walk.Take());
    const size_t before = follower.state().landmarks.size();
    // The wall is seen nearer from now on.
    walk.room()[3].distance += range_noises * RoomWalk::kRangeNoise;
    const size_t first = follower.state().observations.size();
    for (int i = 0; i < 2 * options_.planes.min_scans; ++i) follower.Follow(walk.Take());
    const bool is_founded = follower.state().landmarks.size() > before;
    EXPECT_EQ(is_founded, range_noises > 5.0);
    if (is_founded) continue;
    // Nor do its segments lie on the plane that it would repeat.
    const auto& observations = follower.state().observations;
    EXPECT_TRUE(std::any_of(
        observations.begin() + static_cast<ptrdiff_t>(first),
        observations.end(),
        [](const Observation& observation) { return observation.landmark_id < 0; }));
  }
}

TEST_F(ScanFollowerTest, BridgesAFewBlindScans) {
  RoomWalk walk;
  ScanFollower follower(walk.rig(), false, options_, RoomWalk::kPeriod);
  ASSERT_TRUE(follower.Start(walk.Take()));
  for (int i = 0; i < 20; ++i) follower.Follow(walk.Take());
  const size_t before = follower.state().landmarks.size();
  for (int i = 0; i < 8; ++i) follower.Follow(walk.TakeBlind());
  for (int i = 0; i < 4; ++i) follower.Follow(walk.Take());
  EXPECT_EQ(follower.state().landmarks.size(), before) << "it knows the planes again";
  EXPECT_EQ(follower.scan_times_ns().size(), 33U);
}

// White acceleration a over knots of T lets the velocity wander by a sqrt(T t), the position
// by a sqrt(T t^3 / 3) on each axis: half a metre on two of them after t = 0.7 s.
TEST_F(ScanFollowerTest, ReportsLossAfterTheLongestGap) {
  constexpr double kSecondsToLoss = 0.7;
  Start(20);
  const int64_t last_seen_ns = walk_.now_ns();
  std::string message;
  while (message.empty()) {
    const Scan scan = walk_.TakeBlind();
    message = ErrorOf([&] { follower_.Follow(scan); });
    ASSERT_LT(SecondsBetween(last_seen_ns, walk_.now_ns()),
              options_.max_gap_s + kSecondsToLoss + options_.trajectory.knot_interval_s)
        << "no loss reported";
  }
  EXPECT_THAT(message, testing::StartsWith("lost track of the rig"));
  EXPECT_GT(SecondsBetween(last_seen_ns, walk_.now_ns()), options_.max_gap_s);
}

TEST_F(ScanFollowerTest, LeavesOutAScannerThatHasFrozen) {
  Start(10);
  const Scan frozen = walk_.Take();
  follower_.Follow(frozen);
  const int first = static_cast<int>(follower_.scan_times_ns().size());
  for (int i = 0; i < 5; ++i) {
    Scan scan = walk_.Take();
    scan.scan_lines[1].ranges = frozen.scan_lines[1].ranges;
    follower_.Follow(scan);
  }
  int num_of_others = 0;
  for (const Observation& observation : follower_.state().observations) {
    if (observation.scan_index < first) continue;
    EXPECT_NE(observation.scanner_index, 1);
    ++num_of_others;
  }
  EXPECT_GT(num_of_others, 10);
}

TEST_F(ScanFollowerTest, TakesBackWhatCameAfterTheLastKnownPose) {
  Start(20);
  for (;;) {
    const Scan scan = walk_.TakeBlind();
    if (!ErrorOf([&] { follower_.Follow(scan); }).empty()) break;
  }
  const size_t before = follower_.scan_times_ns().size();
  follower_.EndAtLastKnown();
  const std::vector<int64_t>& times_ns = follower_.scan_times_ns();
  EXPECT_GE(times_ns.size(), 21U);
  EXPECT_LT(times_ns.size(), before);
  const MapState& state = follower_.state();
  EXPECT_GT(state.trajectory.end_ns(), times_ns.back());
  EXPECT_LT(SecondsBetween(times_ns.back(), state.trajectory.end_ns()),
            2.0 * state.trajectory.knot_interval_s());
  for (const Observation& observation : state.observations) {
    EXPECT_LT(observation.scan_index, static_cast<int>(times_ns.size()));
  }
}

}  // namespace
}  // namespace plumbline
