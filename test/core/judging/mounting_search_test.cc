#include "core/judging/mounting_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/angles.h"
#include "core/judging/mounting_fit.h"
#include "test/core/judging/turning_rig.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

const std::vector<std::string> kNames = {"top", "left", "right"};

// The paper's rig takes the lines; each test holds them against another rig file.
class MountingSearchTest : public testing::Test {
 protected:
  MountedRig RigFile() const { return AsRigFileSays(rig_, {0, 1, 2}); }

  Rig rig_ = MakePaperRig();
  std::vector<std::vector<SampledLine>> sample_ = TurningRig(rig_).TakeSample();
};

TEST_F(MountingSearchTest, TheScannersOfARightRigAgree) {
  int num_compared = 0;
  for (const PairAgreement& pair : AgreementsOf(sample_, RigFile())) {
    num_compared += pair.num_compared;
    if (pair.num_compared == 0) continue;
    EXPECT_GT(pair.near_share, 0.95) << pair.a << " and " << pair.b;
    EXPECT_LT(pair.median_m, SixWalls::kRangeNoise) << pair.a << " and " << pair.b;
  }
  EXPECT_GT(num_compared, 80);
  EXPECT_FALSE(FindOtherMounting(sample_, RigFile(), kNames));
}

TEST_F(MountingSearchTest, NamesAMirroredScanner) {
  MountedRig file = RigFile();
  file[0].mirrored = true;
  const auto other = FindOtherMounting(sample_, file, kNames);
  ASSERT_TRUE(other);
  EXPECT_THAT(other->words, HasSubstr("scanner top is mirrored"));
  EXPECT_FALSE(other->rig[0].mirrored);
  EXPECT_LT(other->share_as_stated, 0.6);
  EXPECT_GT(other->share_so, 0.95);
}

TEST_F(MountingSearchTest, NamesExchangedScanners) {
  const auto other = FindOtherMounting(sample_, AsRigFileSays(rig_, {0, 2, 1}), kNames);
  ASSERT_TRUE(other);
  EXPECT_THAT(other->words, HasSubstr("left and right are exchanged"));
  EXPECT_EQ(other->rig[1].source, 1u);
  EXPECT_EQ(other->rig[2].source, 2u);
}

TEST_F(MountingSearchTest, NamesAnotherUnit) {
  for (SampledLine& line : sample_[2]) {
    for (SampledSegment& segment : line.segments) {
      segment.start /= 0.3048;
      segment.end /= 0.3048;
    }
  }
  const auto other = FindOtherMounting(sample_, RigFile(), kNames);
  ASSERT_TRUE(other);
  EXPECT_THAT(other->words, HasSubstr("right gives its ranges in feet"));
}

TEST_F(MountingSearchTest, NamesAQuarterTurn) {
  MountedRig file = RigFile();
  file[0].body_from_scanner.rotation =
      file[0].body_from_scanner.rotation *
      Eigen::Quaterniond(Eigen::AngleAxisd(-M_PI / 2.0, Eigen::Vector3d::UnitZ()));
  const auto other = FindOtherMounting(sample_, file, kNames);
  ASSERT_TRUE(other);
  EXPECT_THAT(other->words, HasSubstr("top is turned in its own plane by 90 deg"));
}

// The rig file says too little by an angle, a time and a length: the correction is these.
TEST_F(MountingSearchTest, FindsTurnAndTimeOffset) {
  constexpr double kTurn = 4.0 * kRadiansPerDegree;
  constexpr double kLate = 0.03;  // s
  MountedRig file = RigFile();
  file[1].body_from_scanner.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(-kTurn, Eigen::Vector3d::UnitZ())) *
      file[1].body_from_scanner.rotation;
  file[1].time_offset_s = kLate;
  const MountingCorrection correction = FitMountings(sample_, file)[1];
  EXPECT_LT(correction.near_share, 0.7);
  EXPECT_GT(correction.moved_share, 0.9);
  EXPECT_NEAR(correction.rotation_rad.z(), kTurn, 0.1 * kTurn);
  EXPECT_NEAR(correction.time_offset_s, -kLate, 0.1 * kLate);
  EXPECT_NEAR(correction.corrected.time_offset_s, 0.0, 0.1 * kLate);
}

TEST_F(MountingSearchTest, CorrectsNothingOfARightRig) {
  for (const MountingCorrection& correction : FitMountings(sample_, RigFile())) {
    EXPECT_GT(correction.near_share, 0.95);
    EXPECT_LT(correction.rotation_rad.norm(), 0.5 * kRadiansPerDegree);
    EXPECT_LT(correction.translation_m.norm(), 0.02);
    EXPECT_LT(correction.moved_share - correction.near_share, 0.03);
    EXPECT_LT(std::abs(correction.time_offset_s), 0.004);
  }
}

// A rig that stands for half a minute shows one place with one error, the first line's, which
// says nothing of a scanner.
TEST_F(MountingSearchTest, StandingProvesNothing) {
  std::vector<std::vector<SampledLine>> standing = sample_;
  for (std::vector<SampledLine>& lines : standing) {
    SampledLine first = lines.front();
    for (SampledSegment& segment : first.segments) {
      const double longer = &lines == &standing[0] ? 0.02 : 0.0;
      segment.start += longer * segment.start.normalized();
      segment.end += longer * segment.end.normalized();
    }
    std::vector<SampledLine> repeated(600, first);
    for (size_t k = 0; k < repeated.size(); ++k) {
      repeated[k].stamp_ns -=
          NanosecondsFromSeconds(static_cast<double>(repeated.size() - k) / TurningRig::kRate);
    }
    lines.insert(lines.begin(), repeated.begin(), repeated.end());
  }
  const std::vector<MountingCorrection> moving = FitMountings(sample_, RigFile());
  const std::vector<MountingCorrection> with_standing = FitMountings(standing, RigFile());
  for (size_t i = 0; i < moving.size(); ++i) {
    EXPECT_LE(with_standing[i].num_compared, moving[i].num_compared + 4);
    EXPECT_LT(with_standing[i].moved_share - with_standing[i].near_share, 0.03);
    EXPECT_NEAR(with_standing[i].range_offset_m, moving[i].range_offset_m, 0.005);
  }
}

// Turns that no fit finds from where the rig file says.
TEST_F(MountingSearchTest, FindsLargeTurns) {
  const Eigen::Quaterniond stated = RigFile()[0].body_from_scanner.rotation;
  MountedRig file = RigFile();
  file[0].body_from_scanner.rotation =
      stated * Eigen::AngleAxisd(-130.0 * kRadiansPerDegree, Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(FindOtherMounting(sample_, file, kNames));
  const auto other = FindTurn(sample_, file, kNames);
  ASSERT_TRUE(other);
  EXPECT_THAT(other->words, HasSubstr("scanner top is turned by 130 deg about the vertical"));
  EXPECT_LT(other->rig[0].body_from_scanner.rotation.angularDistance(stated),
            0.5 * kRadiansPerDegree);
}

// A scanner that nobody can be compared with is left alone.
TEST_F(MountingSearchTest, OneScannerIsNotCompared) {
  const MountedRig one = {RigFile()[0]};
  EXPECT_TRUE(AgreementsOf(sample_, one).empty());
  EXPECT_EQ(FitMountings(sample_, one)[0].num_compared, 0);
}

}  // namespace
}  // namespace plumbline
