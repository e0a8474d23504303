#include "core/estimation/block_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(BlockIdTest, ControlPointsPlanesScannersAndImuFollowEachOther) {
  const std::vector<BlockId> in_order = {RotationBlock(0),
                                         PositionBlock(0),
                                         RotationBlock(1),
                                         PositionBlock(1),
                                         GyroscopeBiasBlock(1),
                                         AccelerometerBiasBlock(1),
                                         RotationBlock(2),
                                         GyroscopeBiasBlock(3),
                                         LandmarkBlock(0),
                                         LandmarkBlock(7),
                                         ScannerBlockId(0),
                                         ScannerBlockId(1),
                                         ImuBlockId()};
  for (size_t i = 0; i < in_order.size(); ++i) {
    for (size_t k = 0; k < in_order.size(); ++k) {
      EXPECT_EQ(in_order[i] < in_order[k], i < k) << i << " " << k;
      EXPECT_EQ(in_order[i] == in_order[k], i == k) << i << " " << k;
    }
  }
}

TEST(BlockIdTest, EachIsOfOneKind) {
  for (const BlockId& block : {RotationBlock(2),
                               PositionBlock(2),
                               LandmarkBlock(2),
                               ScannerBlockId(2),
                               ImuBlockId(),
                               GyroscopeBiasBlock(2),
                               AccelerometerBiasBlock(2)}) {
    EXPECT_EQ(IsControlPoint(block) + IsLandmark(block) + IsScanner(block) + IsImu(block) +
                  IsBias(block),
              1);
  }
}

// What a window gives up.
TEST(BlockIdTest, PosesAndBiasesComeBeforeAControlPointAndNothingElseDoes) {
  EXPECT_TRUE(IsBefore(RotationBlock(2), 3));
  EXPECT_TRUE(IsBefore(PositionBlock(2), 3));
  EXPECT_TRUE(IsBefore(GyroscopeBiasBlock(2), 3));
  EXPECT_FALSE(IsBefore(PositionBlock(3), 3));
  EXPECT_FALSE(IsBefore(AccelerometerBiasBlock(3), 3));
  EXPECT_FALSE(IsBefore(LandmarkBlock(2), 3));
  EXPECT_FALSE(IsBefore(ScannerBlockId(0), 3));
  EXPECT_FALSE(IsBefore(ImuBlockId(), 3));
}

TEST(BlockLayoutTest, ControlPointsTakeTheFirstColumns) {
  BlockLayout layout;
  layout.blocks = {RotationBlock(4), PositionBlock(4), LandmarkBlock(1), ScannerBlockId(0)};
  layout.offsets = {0, 1, 4, 6, 13};
  EXPECT_EQ(layout.size(), 13);
  EXPECT_EQ(layout.NumBandColumns(), 4);
  layout.blocks = {RotationBlock(4), PositionBlock(4), ScannerBlockId(0)};  // no planes
  layout.offsets = {0, 1, 4, 11};
  EXPECT_EQ(layout.NumBandColumns(), 4);
  layout.blocks.resize(2);
  layout.offsets.resize(3);
  EXPECT_EQ(layout.NumBandColumns(), 4);  // there is nothing else
  layout.blocks = {LandmarkBlock(1)};
  layout.offsets = {0, 2};
  EXPECT_EQ(layout.NumBandColumns(), 0);
}

TEST(BlockLayoutTest, BiasesLieInTheBand) {
  BlockLayout layout;
  EXPECT_EQ(BlockLayout().WidthOfBiases(), 0);
  layout.offsets = {0};
  const auto add = [&](const BlockId& block, int size) {
    layout.blocks.push_back(block);
    layout.offsets.push_back(layout.offsets.back() + size);
  };
  for (int i = 0; i < 4; ++i) {
    add(RotationBlock(i), 3);
    add(PositionBlock(i), 3);
    if (i % 2 == 0) continue;
    add(GyroscopeBiasBlock(i), 3);
    add(AccelerometerBiasBlock(i), 3);
  }
  add(LandmarkBlock(0), 3);
  EXPECT_EQ(layout.NumBandColumns(), 36);
  EXPECT_EQ(layout.ColumnOf(RotationBlock(2)), 18);
  EXPECT_EQ(layout.ColumnOf(LandmarkBlock(0)), 36);
  EXPECT_EQ(layout.WidthOfBiases(), 18);  // two control points and a node
  // Nodes after the last control point follow each other, but are two.
  BlockLayout ending;
  ending.offsets = {0};
  std::swap(layout, ending);
  for (int i = 0; i < 3; ++i) add(RotationBlock(i), 3);
  for (const int last : {1, 3, 5}) {
    add(GyroscopeBiasBlock(last), 3);
    add(AccelerometerBiasBlock(last), 3);
  }
  std::sort(layout.blocks.begin(), layout.blocks.end());
  EXPECT_EQ(layout.WidthOfBiases(), 12);
}

TEST(BlockLayoutTest, FreeColumnsAreThoseThatNoManifoldHolds) {
  BlockLayout layout;
  layout.blocks = {RotationBlock(0), PositionBlock(0), LandmarkBlock(1)};
  layout.offsets = {0, 1, 4, 6};
  layout.is_free = {true, true, true, false, false, true};
  EXPECT_THAT(layout.FreeColumns(), ElementsAre(0, 1, 2, 5));
  layout.is_free.assign(6, false);
  EXPECT_THAT(layout.FreeColumns(), IsEmpty());
}

}  // namespace
}  // namespace plumbline
