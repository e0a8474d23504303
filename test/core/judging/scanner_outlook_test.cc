#include "core/judging/scanner_outlook.h"

#include <gtest/gtest.h>

#include "test/core/judging/turning_rig.h"

namespace plumbline {
namespace {

// A level scanner, an upright one and a tilted one.
Rig MixedRig() {
  Rig rig = MakePaperRig();
  rig.scanners[2].body_from_scanner.rotation = RotationFromRollPitchYaw(M_PI / 2.0, 0.0, 0.3);
  return rig;
}

TEST(ScannerOutlookTest, TellsLevelScannersFromTiltedOnes) {
  const auto attitudes = JudgeAttitudes(TurningRig(MixedRig()).TakeSample());
  ASSERT_EQ(attitudes.size(), 3u);
  EXPECT_EQ(attitudes[0].attitude, Attitude::kLevel);
  EXPECT_EQ(attitudes[1].attitude, Attitude::kTilted);
  EXPECT_EQ(attitudes[2].attitude, Attitude::kTilted);
}

TEST(ScannerOutlookTest, WithoutTurnsNothingIsTold) {
  const std::vector<std::vector<SampledLine>> nothing(2);
  for (const OwnAttitude& own : JudgeAttitudes(nothing)) {
    EXPECT_EQ(own.attitude, Attitude::kUnknown);
  }
}

TEST(ScannerOutlookTest, FindsFloorAndCeiling) {
  const Rig rig = MixedRig();
  const auto sample = TurningRig(rig).TakeSample();
  EXPECT_FALSE(FindHeights(sample[0], rig.scanners[0]).is_tilted);
  for (size_t i = 1; i < 3; ++i) {
    const HeightView view = FindHeights(sample[i], rig.scanners[i]);
    EXPECT_TRUE(view.is_tilted);
    ASSERT_TRUE(view.floor.is_seen) << i;
    EXPECT_NEAR(view.floor.height_m, TurningRig::kFloorHeight, 0.05) << i;
  }
  const HeightView upright = FindHeights(sample[2], rig.scanners[2]);
  ASSERT_TRUE(upright.ceiling.is_seen);
  EXPECT_NEAR(upright.ceiling.height_m, TurningRig::kCeilingHeight, 0.05);
}

}  // namespace
}  // namespace plumbline
