#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "core/map/imu_estimate.h"
#include "core/sensor/rig.h"
#include "factors/segment/scanner_block.h"

namespace plumbline {

// Numbers of the mount come last; without a mount they are 0.
using ScannerBlock = std::array<double, kMountedBlockSize>;
using ScannerMatrix = Eigen::Matrix<double, kMountedBlockSize, kMountedBlockSize>;

// ScannerEstimate is what is estimated of one scanner: a block about the pose and the clock
// that the rig file states (factors/segment/scanner_block.h).
struct ScannerEstimate {
  Rigid3d stated;                 // body_from_scanner of the rig file
  bool is_mounted = false;        // on a mount
  MountPose stated_mount;         // of the rig file
  bool is_body = false;           // its frame and clock are the body's, held
  ScannerBlock block = {};        // as it is estimated now
  ScannerBlock prior_sigma = {};  // of the rig file's statement; 0: held
  ScannerMatrix covariance = ScannerMatrix::Zero();  // of the block as it is now

  bool IsEstimated() const;
  // Takes the block's covariance from a joint one, in which it begins at a row.
  void SetCovariance(const Eigen::MatrixXd& joint, Eigen::Index row);
  int BlockSize() const { return is_mounted ? kMountedBlockSize : kScannerBlockSize; }
};

// Standard deviations of a block's numbers, as a rig file states them.
ScannerBlock StatedSigmas(const Scanner& scanner);

// Axis and zero of a mount, as they are estimated.
MountPose PoseOf(const Mount& mount);
// The motion of a mount as it is estimated, at an instant and so many seconds later.
MountMotion MotionOf(const Mount& mount, int64_t time_ns, double later_s);

// RigCalibration is the part of the state that the scanners are (docs/calibration.md). The
// body's frame, clock and metre are those of BodyScanner, which are held. A rig that moves in
// the plane does not show heights and tilts, which are held. A turn of a scanner about the
// axis of its mount is the zero of the mount's angle: the scanner's own is held about that
// axis of the body which is nearest to the mount's.
struct RigCalibration {
  std::vector<ScannerEstimate> scanners;  // parallel to the rig's; empty: none is estimated
  std::optional<ImuEstimate> imu;

  RigCalibration() = default;
  RigCalibration(const Rig& rig, bool planar);

  // Whether this scanner of the rig is estimated.
  bool IsEstimated(int scanner) const {
    const auto index = static_cast<size_t>(scanner);
    return index < scanners.size() && scanners[index].IsEstimated();
  }
  // Sets the scanners' poses, delays and range excesses in the rig to the estimated ones. Time
  // offsets and range biases stay, as what has been measured does.
  void ApplyTo(Rig* rig) const;
  // A rig with poses, delays and range excesses as they are estimated.
  Rig Posed(Rig rig) const;
  // The rig of a rig file with poses, time offsets and range biases as they are estimated.
  Rig Calibrated(Rig rig) const;
};

}  // namespace plumbline
