#include "core/registration/scan_matching.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test/testing/room_walk.h"

namespace plumbline {
namespace {

constexpr double kDegree = M_PI / 180.0;

// A rig that walks through a room whose planes nobody knows: the local map alone holds it.
class ScanMatchingTest : public testing::Test {
 protected:
  // A trajectory that stands at rest with this error from where the rig is now.
  Trajectory Predicted(double yaw, const Eigen::Vector3d& shift) const {
    Rigid3d pose = walk_.WorldFromBody(walk_.now_ns());
    pose.rotation = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * pose.rotation;
    pose.translation += shift;
    Trajectory trajectory(walk_.now_ns() - 100'000'000, 125'000'000, pose);
    trajectory.ExtendTo(walk_.now_ns() + 100'000'000);
    return trajectory;
  }

  // The local map takes in scans with the true poses.
  void Remember(int num_scans) {
    for (int i = 0; i < num_scans; ++i) {
      const Trajectory truth = Predicted(0.0, Eigen::Vector3d::Zero());
      matcher_.Take(walk_.Take());
      matcher_.Remember(truth, true);
    }
  }

  static MotionMatrix Covariance(double rotation, double position) {
    MotionVector variances;
    for (int i = 0; i < 12; ++i) {
      const double sigma = i % 6 < 3 ? rotation : position;
      variances[i] = sigma * sigma;
    }
    MotionMatrix covariance = variances.asDiagonal();
    // Both ends of a short scan err nearly alike.
    covariance.topRightCorner<6, 6>() = 0.99 * covariance.topLeftCorner<6, 6>();
    covariance.bottomLeftCorner<6, 6>() = covariance.topRightCorner<6, 6>();
    return covariance;
  }

  // How far the pose that the match was linearised at lies from the truth.
  static double PositionError(const ScanMatch& match, const Rigid3d& truth) {
    return (match.constraints.front().measurement.position - truth.translation).norm();
  }

  MapperOptions options_;
  RoomWalk walk_{Eigen::Vector3d(0.4, -0.3, 0.0)};
  ScanMatcher matcher_{walk_.rig(), false, options_.points, RoomWalk::kPeriod};
};

TEST_F(ScanMatchingTest, FindsTheScanWhereTheLocalMapHasIt) {
  Remember(90);
  const Rigid3d truth = walk_.WorldFromBody(walk_.now_ns());
  const Trajectory predicted = Predicted(2.0 * kDegree, Eigen::Vector3d(0.06, -0.05, 0.0));
  matcher_.Take(walk_.Take());
  const ScanMatch before = matcher_.Match(predicted, 0, nullptr);
  const ScanMatch match = matcher_.Register(predicted, Covariance(3.0 * kDegree, 0.1));
  EXPECT_GT(match.num_near, before.num_near);
  EXPECT_GT(match.NearShare(), 0.9);
  EXPECT_LT(PositionError(match, truth), 0.02);
  const Eigen::Quaterniond& rotation = match.constraints.front().measurement.world_from_body;
  EXPECT_LT(rotation.angularDistance(truth.rotation), 0.5 * kDegree);
}

// Beyond the reach of the cells, one of the turns that are tried finds it.
TEST_F(ScanMatchingTest, FindsALargeTurn) {
  Remember(90);
  const Rigid3d truth = walk_.WorldFromBody(walk_.now_ns());
  const Trajectory predicted = Predicted(14.0 * kDegree, Eigen::Vector3d::Zero());
  matcher_.Take(walk_.Take());
  const ScanMatch match = matcher_.Register(predicted, Covariance(8.0 * kDegree, 0.05));
  const Eigen::Quaterniond& rotation = match.constraints.front().measurement.world_from_body;
  EXPECT_LT(rotation.angularDistance(truth.rotation), 1.0 * kDegree);
}

// Farther than any covariance: the search knows but a window.
TEST_F(ScanMatchingTest, SearchesAWindow) {
  Remember(90);
  const Rigid3d truth = walk_.WorldFromBody(walk_.now_ns());
  matcher_.Take(walk_.Take());
  for (const double side : {-1.0, 1.0}) {
    const Trajectory predicted =
        Predicted(side * 30.0 * kDegree, Eigen::Vector3d(0.7, -0.6 * side, 0.0));
    const ScanMatch match = matcher_.Search(predicted, Rigid3d(), SearchWindow());
    const Eigen::Quaterniond& rotation = match.constraints.front().measurement.world_from_body;
    EXPECT_LT(PositionError(match, truth), 0.05);
    EXPECT_LT(rotation.angularDistance(truth.rotation), 1.0 * kDegree);
    // The same about where a correction takes the scan.
    const Rigid3d half = {Eigen::Quaterniond(Eigen::AngleAxisd(-side * 15.0 * kDegree,
                                                               Eigen::Vector3d::UnitZ())),
                          Eigen::Vector3d::Zero()};
    const ScanMatch about = matcher_.Search(predicted, half, SearchWindow());
    EXPECT_LT(PositionError(about, truth), 0.05);
  }
}

TEST_F(ScanMatchingTest, OnlyTheChosenBeamsCount) {
  Remember(90);
  const Trajectory truth = Predicted(0.0, Eigen::Vector3d::Zero());
  const Scan scan = walk_.Take();
  matcher_.Take(scan);
  BeamMask mask = matcher_.AllBeams();
  EXPECT_EQ(matcher_.Match(truth, 0, &mask).num_points, matcher_.num_points());
  for (size_t i = 0; i < scan.scan_lines.size(); ++i) {
    matcher_.Exclude(scan.scan_line_indices[i], 0, scan.scan_lines[i].num_beams() - 1, &mask);
  }
  EXPECT_EQ(matcher_.Match(truth, 0, &mask).num_points, 0);
}

TEST_F(ScanMatchingTest, ANewPlaceIsUnknown) {
  matcher_.Take(walk_.Take());
  EXPECT_EQ(matcher_.Match(Predicted(0.0, Eigen::Vector3d::Zero()), 0, nullptr).num_known, 0);
}

// Somebody steps into the view of the level scanner, half way to the wall: where beams passed.
TEST_F(ScanMatchingTest, LeavesOutWhatMoves) {
  constexpr int kFirst = 100;
  constexpr int kLast = 110;
  Remember(90);
  const Trajectory truth = Predicted(0.0, Eigen::Vector3d::Zero());
  Scan scan = walk_.Take();
  for (int beam = kFirst; beam <= kLast; ++beam) {
    scan.scan_lines[0].ranges[static_cast<size_t>(beam)] *= 0.5f;
  }
  matcher_.Take(scan);
  const int num_points = matcher_.num_points();
  matcher_.LeaveOutMoving(truth);
  const int line = scan.scan_line_indices[0];
  EXPECT_TRUE(matcher_.IsMoving(line, kFirst, kLast));
  EXPECT_FALSE(matcher_.IsMoving(line, kLast + 5, kLast + 40));
  EXPECT_FALSE(matcher_.IsMoving(scan.scan_line_indices[1], kFirst, kLast));
  EXPECT_NEAR(num_points - matcher_.num_points(), kLast - kFirst + 1, 4);
  EXPECT_EQ(matcher_.Match(truth, 0, nullptr).num_points, matcher_.num_points());
}

// A metre off, the walls on one side stand in the room, which the rig has seen to be empty.
TEST_F(ScanMatchingTest, AWrongPosePutsPointsIntoEmptySpace) {
  Remember(90);
  matcher_.Take(walk_.Take());
  EXPECT_EQ(matcher_.NumInEmpty(Predicted(0.0, Eigen::Vector3d::Zero())), 0);
  EXPECT_GT(matcher_.NumInEmpty(Predicted(0.0, Eigen::Vector3d(1.0, 0.0, 0.0))),
            matcher_.num_points() / 20);
}

// Where most of what is seen lies in free space, it is the pose that is wrong.
TEST_F(ScanMatchingTest, AWrongPoseMovesNothing) {
  Remember(90);
  Scan scan = walk_.Take();
  for (ScanLine& line : scan.scan_lines) {
    for (float& range : line.ranges) range *= 0.6f;
  }
  matcher_.Take(scan);
  const int num_points = matcher_.num_points();
  matcher_.LeaveOutMoving(Predicted(0.0, Eigen::Vector3d::Zero()));
  EXPECT_EQ(matcher_.num_points(), num_points);
}

TEST_F(ScanMatchingTest, SeesWhetherAnythingMoves) {
  EXPECT_TRUE(matcher_.SeesMotion()) << "nobody can tell yet";
  const auto take_scans = [&](int num_scans, bool with_somebody) {
    for (int i = 0; i < num_scans; ++i) {
      const Trajectory truth = Predicted(0.0, Eigen::Vector3d::Zero());
      Scan scan = walk_.Take();
      for (int beam = 100; with_somebody && beam <= 120; ++beam) {
        scan.scan_lines[0].ranges[static_cast<size_t>(beam)] *= 0.5f;
      }
      matcher_.Take(scan);
      matcher_.LeaveOutMoving(truth);
      matcher_.Remember(truth, true);
    }
  };
  take_scans(100, false);
  EXPECT_FALSE(matcher_.SeesMotion());
  take_scans(40, true);
  EXPECT_TRUE(matcher_.SeesMotion());
}

}  // namespace
}  // namespace plumbline
