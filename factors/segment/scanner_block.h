#pragma once

#include <Eigen/Core>

#include "factors/spline/so3.h"

namespace plumbline {

// The unknowns of a scanner, as a parameter block about the pose that its rig file states:
//   [ turn (rad) | shift (m) | delay (s) | range bias (m) | range scale (-) ]
// turn, shift: in the body frame; body_from_scanner = ( Exp(turn) R, t + shift ).
// delay: the scanner's points were taken later by this than its stamps say. range bias: by
// what its ranges are too long. range scale: by what share of them the ranges are too long.
enum ScannerBlockAt {
  kScannerTurnAt = 0,
  kScannerShiftAt = 3,
  kScannerDelayAt = 6,
  kScannerRangeAt = 7,
  kScannerScaleAt = 8,
  kScannerBlockSize = 9,
  // Errors of the ranges, bias and scale, side by side.
  kNumRangeErrors = kScannerBlockSize - kScannerRangeAt
};

struct ScannerPose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double range_scale = 1.0;  // true range by measured one
};

// The pose and the scale that the block stands for, about the stated ones.
inline ScannerPose PoseOfScanner(const ScannerPose& stated, const double* block) {
  using Vector = Eigen::Map<const Eigen::Vector3d>;
  const Eigen::Vector3d turn = Vector(block + kScannerTurnAt);
  return {Exp(turn).toRotationMatrix() * stated.rotation,
          stated.translation + Vector(block + kScannerShiftAt),
          stated.range_scale * (1.0 - block[kScannerScaleAt])};
}

// Moving a scanner is moving the body: the body's motion (world-frame turn, shift) by the
// scanner's block, at an instant with these velocities in the world. Errors of its ranges move
// nothing.
using BodyByScanner = Eigen::Matrix<double, 6, kScannerBlockSize>;

inline BodyByScanner BodyMotionByScanner(const Eigen::Matrix3d& world_from_body,
                                         const ScannerPose& scanner,
                                         const double* block,
                                         const Eigen::Vector3d& angular_rad_s,
                                         const Eigen::Vector3d& linear_m_s) {
  BodyByScanner by_scanner = BodyByScanner::Zero();
  const Eigen::Map<const Eigen::Vector3d> rotation_vector(block + kScannerTurnAt);
  const Eigen::Matrix3d turn = world_from_body * LeftJacobian(rotation_vector);
  by_scanner.block<3, 3>(0, kScannerTurnAt) = turn;
  // The scanner turns about itself, not about the body.
  by_scanner.block<3, 3>(3, kScannerTurnAt) =
      SkewMatrix(world_from_body * scanner.translation) * turn;
  by_scanner.block<3, 3>(3, kScannerShiftAt) = world_from_body;
  by_scanner.block<3, 1>(0, kScannerDelayAt) = angular_rad_s;
  by_scanner.block<3, 1>(3, kScannerDelayAt) = linear_m_s;
  return by_scanner;
}

}  // namespace plumbline
