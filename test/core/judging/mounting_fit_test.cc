#include "core/judging/mounting_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/angles.h"
#include "core/geometry/roll_pitch_yaw.h"
#include "test/core/judging/turning_rig.h"

namespace plumbline {
namespace {

// Level scanners show how they are turned about the vertical, and nothing of how they tilt.
TEST(MountingFit, LevelScannersKeepTheirTiltsAndHeights) {
  Rig rig = MakePaperRig();
  for (size_t i = 0; i < rig.scanners.size(); ++i) {
    const auto number = static_cast<double>(i);
    rig.scanners[i].body_from_scanner = {RotationFromRollPitchYaw(0.0, 0.0, 2.0 * number),
                                         Eigen::Vector3d(0.1 * number, 0.0, 0.0)};
  }
  const std::vector<std::vector<SampledLine>> sample = TurningRig(rig).TakeSample();
  MountedRig file = AsRigFileSays(rig, {0, 1, 2});
  for (size_t i = 1; i < file.size(); ++i) {
    const double yaw = (i == 1 ? 3.0 : -3.0) * kRadiansPerDegree;
    const Eigen::Quaterniond off = RotationFromRollPitchYaw(0.5 * kRadiansPerDegree, 0.0, yaw);
    file[i].body_from_scanner.rotation = off * file[i].body_from_scanner.rotation;
    file[i].body_from_scanner.translation.z() = 0.01;
  }
  const MountedRig fitted = FitInTurns(sample, file, 0, true);
  for (size_t i = 1; i < file.size(); ++i) {
    const Eigen::Quaterniond left = fitted[i].body_from_scanner.rotation *
                                    rig.scanners[i].body_from_scanner.rotation.conjugate();
    const Eigen::Vector3d rpy = RollPitchYawDegrees(left);
    EXPECT_NEAR(std::hypot(rpy.x(), rpy.y()), 0.5, 1e-3) << "as the file has it";
    EXPECT_NEAR(rpy.z(), 0.0, 0.2) << "3 degrees in the file";
    EXPECT_NEAR(fitted[i].body_from_scanner.translation.z(), 0.01, 1e-6);
  }
}

TEST(MountingFit, RangesAreAsTheRigFileCorrectsThem) {
  Rig rig = MakePaperRig();
  const std::vector<std::vector<SampledLine>> sample = TurningRig(rig).TakeSample();
  const auto distance = [&] {
    double sum = 0.0;
    const auto comparisons = CompareViews(sample, AsRigFileSays(rig, {0, 1, 2}), 0, 1, 200);
    for (const ViewComparison& one : comparisons) sum += std::abs(one.distance_m);
    return sum / static_cast<double>(comparisons.size());
  };
  const double right = distance();
  rig.scanners[1].range_scale = 1.05;
  EXPECT_GT(distance(), right + 0.03) << "a twentieth of a few metres";
}

}  // namespace
}  // namespace plumbline
