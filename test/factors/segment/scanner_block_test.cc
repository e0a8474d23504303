#include "factors/segment/scanner_block.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

// A body that turns and moves evenly.
constexpr double kStep = 1e-6;
const Eigen::Vector3d kAngular(0.3, -0.5, 0.9);  // rad/s, world
const Eigen::Vector3d kLinear(1.1, 0.4, -0.2);   // m/s, world
const Eigen::Matrix3d kBody = Exp(Eigen::Vector3d(0.4, -0.2, 1.3)).toRotationMatrix();
const Eigen::Vector3d kPosition(2.0, -1.0, 1.5);

// A place that a scanner with this block sees, in the world.
Eigen::Vector3d Seen(const ScannerPose& stated,
                     const Eigen::Matrix<double, kScannerBlockSize, 1>& block,
                     const Eigen::Vector3d& p_scanner) {
  const ScannerPose pose = PoseOfScanner(stated, block.data());
  const double delay_s = block[kScannerDelayAt];
  const Eigen::Matrix3d world_from_body =
      Exp(Eigen::Vector3d(delay_s * kAngular)).toRotationMatrix() * kBody;
  return world_from_body * (pose.rotation * p_scanner + pose.translation) + kPosition +
         delay_s * kLinear;
}

// The body's motion (world-frame turn about the body's origin, shift) moves the place as the
// block does.
TEST(ScannerBlock, MovesWhatIsSeenAsTheBodysMotionWould) {
  const ScannerPose stated = {Exp(Eigen::Vector3d(-0.3, 0.8, 0.1)).toRotationMatrix(),
                              {0.1, -0.3, 0.2}};
  const Eigen::Vector3d p_scanner(4.0, -2.5, 0.0);
  Eigen::Matrix<double, kScannerBlockSize, 1> block;
  block << 0.2, -0.1, 0.3, 0.02, -0.03, 0.01, 0.0, 0.01, 0.0;
  const BodyByScanner by_scanner = BodyMotionByScanner(
      kBody, PoseOfScanner(stated, block.data()), block.data(), kAngular, kLinear);
  const Eigen::Vector3d from_body = Seen(stated, block, p_scanner) - kPosition;
  for (int k = 0; k < kScannerBlockSize; ++k) {
    Eigen::Matrix<double, kScannerBlockSize, 1> less = block;
    Eigen::Matrix<double, kScannerBlockSize, 1> more = block;
    less[k] -= kStep;
    more[k] += kStep;
    const Eigen::Vector3d numerical =
        (Seen(stated, more, p_scanner) - Seen(stated, less, p_scanner)) / (2.0 * kStep);
    const Eigen::Vector3d turn = by_scanner.col(k).head<3>();
    const Eigen::Vector3d shift = by_scanner.col(k).tail<3>();
    EXPECT_LT((turn.cross(from_body) + shift - numerical).norm(), 1e-8) << "parameter " << k;
  }
}

using MountedBlock = Eigen::Matrix<double, kMountedBlockSize, 1>;

// A swing of one radian, at an instant.
constexpr double kFrequency = 6.0;  // rad/s
MountMotion MotionAt(double time_s, double since_start_s) {
  return {std::sin(kFrequency * time_s),
          kFrequency * std::cos(kFrequency * time_s),
          -kFrequency * kFrequency * std::sin(kFrequency * time_s),
          since_start_s,
          0.0};
}

// A place that a scanner on a mount sees, in the world.
Eigen::Vector3d SeenOnMount(const ScannerPose& stated,
                            const MountPose& stated_mount,
                            const MountMotion& motion,
                            const MountedBlock& block,
                            const Eigen::Vector3d& p_scanner) {
  const MountPose mount = PoseOfMount(stated_mount, block.data());
  const double angle = MotionOfMount(mount, motion, block.data()).angle_rad;
  return Seen(TurnedBy(angle, mount, PoseOfScanner(stated, block.data())),
              Eigen::Matrix<double, kScannerBlockSize, 1>::Unit(kScannerDelayAt) *
                  block[kScannerDelayAt],
              p_scanner);
}

TEST(ScannerBlock, OnAMountMovesWhatIsSeenAsTheBodysMotionWould) {
  const ScannerPose stated = {Exp(Eigen::Vector3d(-0.3, 0.8, 0.1)).toRotationMatrix(),
                              {0.1, -0.3, 0.2}};
  const MountPose mount = {
      Eigen::Vector3d(0.3, 0.9, -0.2).normalized(), {0.05, -0.1, 0.15}, 0.2};
  const Eigen::Vector3d p_scanner(4.0, -2.5, 0.0);
  MountedBlock block;
  block << 0.2, -0.1, 0.3, 0.02, -0.03, 0.01, 0.001, 0.0, 0.0,  // of the scanner
      0.02, 0.003, 0.0002, 0.03, -0.02, 0.01, -0.02;            // of the mount
  for (const double time_s : {0.0, 0.1, 0.4}) {
    const MountMotion motion = MotionAt(time_s, 9.0);
    const Eigen::Matrix3d body =
        Exp(Eigen::Vector3d(block[kScannerDelayAt] * kAngular)).toRotationMatrix() * kBody;
    const BodyByMounted by_scanner = BodyMotionByMounted(body,
                                                         PoseOfScanner(stated, block.data()),
                                                         mount,
                                                         motion,
                                                         block.data(),
                                                         kAngular,
                                                         kLinear);
    const Eigen::Vector3d from_body = SeenOnMount(stated, mount, motion, block, p_scanner) -
                                      kPosition - block[kScannerDelayAt] * kLinear;
    for (int k = 0; k < kMountedBlockSize; ++k) {
      if (k == kScannerRangeAt || k == kScannerScaleAt) continue;  // not a motion
      MountedBlock less = block;
      MountedBlock more = block;
      less[k] -= kStep;
      more[k] += kStep;
      const Eigen::Vector3d numerical = (SeenOnMount(stated, mount, motion, more, p_scanner) -
                                         SeenOnMount(stated, mount, motion, less, p_scanner)) /
                                        (2.0 * kStep);
      const Eigen::Vector3d turn = by_scanner.col(k).head<3>();
      const Eigen::Vector3d shift = by_scanner.col(k).tail<3>();
      EXPECT_LT((turn.cross(from_body) + shift - numerical).norm(),
                1e-7 * numerical.norm() + 1e-7)
          << "parameter " << k << " at " << time_s;
    }
  }
}

TEST(ScannerBlock, AMountsClockAndRateMoveItsAngle) {
  const MountPose mount;
  MountedBlock block = MountedBlock::Zero();
  block[kMountDelayAt] = 0.003;
  block[kMountRateAt] = 0.0004;
  const double later_s = 0.0004 * 9.0 - 0.003;
  const MountMotion moved = MotionOfMount(mount, MotionAt(0.3, 9.0), block.data());
  EXPECT_NEAR(moved.angle_rad, std::sin(kFrequency * (0.3 + later_s)), 1e-7);
  EXPECT_NEAR(moved.rate_rad_s, kFrequency * std::cos(kFrequency * (0.3 + later_s)), 1e-4);
  // About the instant that the block stands for, the parabola adds nothing.
  MountMotion about = MotionAt(0.3, 9.0);
  about.later_s = later_s;
  EXPECT_NEAR(MotionOfMount(mount, about, block.data()).angle_rad, about.angle_rad, 1e-15);
}

}  // namespace
}  // namespace plumbline
