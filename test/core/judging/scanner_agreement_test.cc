#include "core/judging/scanner_agreement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "test/core/judging/hand_made_map.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// Two scanners that measure ten lines a second, for ten seconds.
class ScannerAgreementTest : public testing::Test {
 protected:
  std::vector<float> NewRanges() {
    std::vector<float> ranges(100);
    std::uniform_real_distribution<float> range(1.0F, 5.0F);
    for (float& one : ranges) one = range(random_);
    return ranges;
  }
  void Take(int scanner, double time_s, const std::vector<float>& ranges, int num_used = 90) {
    activity_.Add(
        scanner, time_s, static_cast<int64_t>(ranges.size()), num_used, FingerprintOf(ranges));
  }
  std::vector<ScannerFault> Find() {
    const auto agreements = CompareScanners(map_.rig(), map_.state(), activity_, 0);
    return FindScannerFaults(map_.rig(), agreements, activity_);
  }

  HandMadeMap map_{2};
  ScannerActivity activity_;
  std::mt19937 random_{1};
};

TEST_F(ScannerAgreementTest, TwoGoodScannersHaveNoFaults) {
  for (int i = 0; i < 100; ++i) {
    Take(0, 0.1 * i, NewRanges());
    Take(1, 0.1 * i, NewRanges());
  }
  EXPECT_THAT(Find(), IsEmpty());
}

TEST_F(ScannerAgreementTest, NamesAFrozenScanner) {
  const std::vector<float> frozen = NewRanges();
  for (int i = 0; i < 100; ++i) {
    Take(0, 0.1 * i, NewRanges());
    Take(1, 0.1 * i, i >= 40 && i < 70 ? frozen : NewRanges());
  }
  const std::vector<ScannerFault> faults = Find();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].scanner_index, 1);
  EXPECT_TRUE(faults[0].contradicts);
  EXPECT_THAT(faults[0].sentence, HasSubstr("scanner_1"));
  EXPECT_THAT(faults[0].sentence, HasSubstr("from 4 to 7 s"));
}

TEST_F(ScannerAgreementTest, NamesASilentScanner) {
  for (int i = 0; i < 100; ++i) {
    Take(0, 0.1 * i, NewRanges());
    Take(1, 0.1 * i, i >= 50 && i < 80 ? std::vector<float>() : NewRanges());
  }
  const std::vector<ScannerFault> faults = Find();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_FALSE(faults[0].contradicts);
  EXPECT_THAT(faults[0].sentence,
              HasSubstr("scanner_1 returned next to nothing from 5 to 8 s"));
}

TEST_F(ScannerAgreementTest, NamesAScannerOffAllPlanes) {
  for (int i = 0; i < 100; ++i) {
    Take(0, 0.1 * i, NewRanges());
    Take(1, 0.1 * i, NewRanges(), 5);
  }
  const std::vector<ScannerFault> faults = Find();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_TRUE(faults[0].contradicts);
  EXPECT_THAT(faults[0].sentence, HasSubstr("only 5 % of its points lie on planes"));
}

// Scanner 1 sees the wall of scanner 0 and more of a plane that scanner 0 does not see:
// another wall is suspicious, a floor is what a level scanner can not see.
TEST_F(ScannerAgreementTest, WhatALevelScannerCanNotSeeIsNotSeenAlone) {
  for (const bool is_floor : {false, true}) {
    HandMadeMap map(2);
    const int wall = map.AddWall(5.0, -2.0, 2.0);
    const int other = map.AddWall(4.0, -2.0, 2.0);
    if (is_floor) {
      Landmark& floor = map.state().landmarks[static_cast<size_t>(other)];
      floor = MakeHorizontalLandmark(1.0, {4.0, 0.0, -1.0});
      floor.id = other;
    }
    for (int second = 0; second < 12; ++second) {
      map.SeeAlong(second, wall, {5.0, -2.0}, {5.0, 2.0}, 0);
      map.SeeAlong(second, wall, {5.0, -2.0}, {5.0, 2.0}, 1);
      map.SeeAlong(second, other, {4.0, -2.0}, {4.0, 2.0}, 1);
    }
    const auto agreements = CompareScanners(map.rig(), map.state(), activity_, 0);
    EXPECT_NEAR(agreements[1].alone_share, is_floor ? 0.0 : 0.5, 1e-9);
    EXPECT_EQ(agreements[0].alone_share, 0.0);
  }
}

}  // namespace
}  // namespace plumbline
