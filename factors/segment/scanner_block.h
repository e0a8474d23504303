#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "factors/spline/so3.h"

namespace plumbline {

// The unknowns of a scanner, as a parameter block about the pose that its rig file states:
//   [ turn (rad) | shift (m) | delay (s) | range bias (m) | range scale (-) ]
// and of one on a mount, which turns it about an axis of the body, after these
//   [ zero (rad) | angles' delay (s) | rate (-) | axis' tilts (rad) | axis' shifts (m) ]
// turn, shift: in the body frame; body_from_scanner = ( Exp(turn) R, t + shift ).
// delay: the scanner's points were taken later by this than its stamps say. range bias: by
// what its ranges are too long. range scale: by what share of them the ranges are too long.
// zero: the mount's angle where it is stated as 0, beyond the stated one. angles' delay: the
// angles were taken later by this than their stamps say. rate: by what share its drive is
// faster than stated. axis' tilts and shifts: along two directions across the stated axis.
// With a mount, turn and shift are those of the pose at angle zero.
enum ScannerBlockAt {
  kScannerTurnAt = 0,
  kScannerShiftAt = 3,
  kScannerDelayAt = 6,
  kScannerRangeAt = 7,
  kScannerScaleAt = 8,
  kScannerBlockSize = 9,
  // Errors of the ranges, bias and scale, side by side.
  kNumRangeErrors = kScannerBlockSize - kScannerRangeAt,
  kMountZeroAt = kScannerBlockSize,
  kMountDelayAt = 10,
  kMountRateAt = 11,
  kMountTiltAt = 12,
  kMountShiftAt = 14,
  kMountedBlockSize = 16
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

// MountPose is the axis of a mount in the body frame, and the mount's angle where it is stated
// as 0.
struct MountPose {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // of unit length
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // on the axis, m
  double zero_rad = 0.0;
};

// MountMotion is the stated angle of a mount at an instant, without zero, by the parabola
// about it; since_start_s: from the instant from which the drive's angle is counted.
struct MountMotion {
  double angle_rad = 0.0;
  double rate_rad_s = 0.0;
  double acceleration_rad_s2 = 0.0;
  double since_start_s = 0.0;
  double later_s = 0.0;  // of the parabola's middle, after the instant
};

// Two directions across the stated axis, along which it tilts and shifts.
inline Eigen::Matrix<double, 3, 2> AcrossAxis(const Eigen::Vector3d& axis) {
  Eigen::Matrix<double, 3, 2> across;
  across.col(0) = axis.unitOrthogonal();
  across.col(1) = axis.cross(across.col(0));
  return across;
}

// The mount that the block stands for, about the stated one.
inline MountPose PoseOfMount(const MountPose& stated, const double* block) {
  const Eigen::Matrix<double, 3, 2> across = AcrossAxis(stated.axis);
  const Eigen::Map<const Eigen::Vector2d> tilts(block + kMountTiltAt);
  const Eigen::Map<const Eigen::Vector2d> shifts(block + kMountShiftAt);
  return {(stated.axis + across * tilts).normalized(),
          stated.point + across * shifts,
          stated.zero_rad + block[kMountZeroAt]};
}

// The angle and the rate of a mount; block: nullptr where the motion is as it is estimated.
inline MountMotion MotionOfMount(const MountPose& mount,
                                 const MountMotion& stated,
                                 const double* block) {
  const double later_s = block == nullptr ? 0.0
                                          : block[kMountRateAt] * stated.since_start_s -
                                                block[kMountDelayAt] + block[kScannerDelayAt] -
                                                stated.later_s;
  MountMotion motion = stated;
  motion.angle_rad += mount.zero_rad + later_s * (stated.rate_rad_s +
                                                  0.5 * later_s * stated.acceleration_rad_s2);
  motion.rate_rad_s += later_s * stated.acceleration_rad_s2;
  return motion;
}

// A scanner's pose in the body at an angle of its mount.
inline ScannerPose TurnedBy(double angle_rad,
                            const MountPose& mount,
                            const ScannerPose& at_zero) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle_rad, mount.axis).toRotationMatrix();
  return {turn * at_zero.rotation,
          mount.point + turn * (at_zero.translation - mount.point),
          at_zero.range_scale};
}

// As BodyMotionByScanner, of a scanner on a mount.
using BodyByMounted = Eigen::Matrix<double, 6, kMountedBlockSize>;

inline BodyByMounted BodyMotionByMounted(const Eigen::Matrix3d& world_from_body,
                                         const ScannerPose& at_zero,
                                         const MountPose& stated_mount,
                                         const MountMotion& stated_motion,
                                         const double* block,
                                         const Eigen::Vector3d& angular_rad_s,
                                         const Eigen::Vector3d& linear_m_s) {
  const MountPose mount = PoseOfMount(stated_mount, block);
  const MountMotion motion = MotionOfMount(mount, stated_motion, block);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(motion.angle_rad, mount.axis).toRotationMatrix();
  // The turn about the axis by one radian: as a turn of the body about its own position.
  const auto about_point = [&](const Eigen::Vector3d& turn_body) {
    Eigen::Matrix<double, 6, 1> moved;
    moved << world_from_body * turn_body, world_from_body * mount.point.cross(turn_body);
    return moved;
  };
  const Eigen::Matrix<double, 6, 1> by_angle = about_point(mount.axis);
  BodyByMounted by_scanner;
  // The scanner as it stands at angle zero, on a body that has the mount's turn.
  const ScannerPose turned = TurnedBy(motion.angle_rad, mount, at_zero);
  by_scanner.leftCols<kScannerBlockSize>() = BodyMotionByScanner(
      world_from_body * turn,
      {at_zero.rotation, turn.transpose() * turned.translation, at_zero.range_scale},
      block,
      angular_rad_s + motion.rate_rad_s * by_angle.head<3>(),
      linear_m_s + motion.rate_rad_s * by_angle.tail<3>());
  by_scanner.col(kMountZeroAt) = by_angle;
  by_scanner.col(kMountDelayAt) = -motion.rate_rad_s * by_angle;
  by_scanner.col(kMountRateAt) = motion.rate_rad_s * motion.since_start_s * by_angle;
  const Eigen::Matrix<double, 3, 2> across = AcrossAxis(stated_mount.axis);
  const Eigen::Map<const Eigen::Vector2d> tilts(block + kMountTiltAt);
  const double length = (stated_mount.axis + across * tilts).norm();
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d tilt =
        (across.col(i) - mount.axis * mount.axis.dot(across.col(i))) / length;
    by_scanner.col(kMountTiltAt + i) =
        about_point(std::sin(motion.angle_rad) * tilt +
                    (1.0 - std::cos(motion.angle_rad)) * mount.axis.cross(tilt));
    by_scanner.col(kMountShiftAt + i) << Eigen::Vector3d::Zero(),
        world_from_body * (across.col(i) - turn * across.col(i));
  }
  return by_scanner;
}

}  // namespace plumbline
