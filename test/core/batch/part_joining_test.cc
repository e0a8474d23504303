#include "core/batch/part_joining.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/geometry/planar_pose.h"
#include "core/sensor/odometry.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr int64_t kKnot = 100'000'000;

// A part of a recording in which the rig stands, and sees nothing.
FollowedPart PartFrom(double start_s, double end_s, const PlanarPose& pose) {
  const Rigid3d world_from_body = {
      Eigen::Quaterniond(Eigen::AngleAxisd(pose.heading, Eigen::Vector3d::UnitZ())),
      {pose.position.x(), pose.position.y(), 0.0}};
  FollowedPart part(MapState{
      Trajectory(NanosecondsFromSeconds(start_s), kKnot, world_from_body), {}, {}, 0, {}});
  part.state.trajectory.ExtendTo(NanosecondsFromSeconds(end_s));
  part.state.observations.emplace_back();
  part.scan_times_ns = {NanosecondsFromSeconds(start_s), NanosecondsFromSeconds(end_s)};
  part.start_s = start_s;
  part.end_s = end_s;
  return part;
}

class PartJoiningTest : public testing::Test {
 protected:
  // Two parts, each in a frame of its own. Between them the wheels say that the rig went 3 m
  // ahead, 1 m to its left, and turned by a quarter.
  FollowedRecording Followed(bool has_wheels) const {
    FollowedRecording followed;
    followed.parts.push_back(PartFrom(1.0, 5.0, {0.5, {1.0, 2.0}}));
    followed.parts.push_back(PartFrom(40.0, 45.0, {-0.7, {0.0, 0.0}}));
    if (!has_wheels) return followed;
    std::vector<OdometrySample> samples;
    for (double time_s = 0.0; time_s < 50.0; time_s += 1.0) {
      const double share = std::min(1.0, std::max(0.0, (time_s - 5.0) / 35.0));
      samples.push_back(
          {NanosecondsFromSeconds(time_s), {share * 3.0, share * 1.0}, share * 0.5 * M_PI});
    }
    for (FollowedPart& part : followed.parts) {
      part.state.odometry = std::make_shared<const Odometry>(samples);
      part.state.odometry_calibration = OdometryCalibration(OdometryOptions());
    }
    return followed;
  }

  Rig rig_;
};

TEST_F(PartJoiningTest, WheelsJoinWhatScansCanNot) {
  FollowedRecording followed = Followed(true);
  JoinParts(rig_, true, &followed);
  ASSERT_EQ(followed.parts.size(), 1u);
  const MapState& state = followed.parts[0].state;
  ASSERT_EQ(state.gaps.size(), 1u);
  const PlanarPose expected = PlanarPose{0.5, {1.0, 2.0}} * PlanarPose{0.5 * M_PI, {3.0, 1.0}};
  const PlanarPose found =
      FromAbove(state.trajectory.WorldFromBody(NanosecondsFromSeconds(42.0)));
  EXPECT_LT((found.position - expected.position).norm(), 1e-6);
  EXPECT_NEAR(std::remainder(found.heading - expected.heading, 2.0 * M_PI), 0.0, 1e-6);
}

TEST_F(PartJoiningTest, WithoutWheelsTheyStayApart) {
  FollowedRecording followed = Followed(false);
  JoinParts(rig_, true, &followed);
  EXPECT_EQ(followed.parts.size(), 2u);
}

TEST_F(PartJoiningTest, WheelsSayNothingOfHeights) {
  FollowedRecording followed = Followed(true);
  JoinParts(rig_, false, &followed);
  EXPECT_EQ(followed.parts.size(), 2u);
}

}  // namespace
}  // namespace plumbline
