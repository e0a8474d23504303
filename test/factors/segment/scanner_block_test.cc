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

}  // namespace
}  // namespace plumbline
