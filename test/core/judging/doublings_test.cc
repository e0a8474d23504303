#include "core/judging/doublings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "test/core/judging/turning_rig.h"

namespace plumbline {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

class DoublingsTest : public testing::Test {
 protected:
  std::vector<std::vector<ScanLine>> lines_ = TurningRig(MakePaperRig()).TakeLines();
};

TEST_F(DoublingsTest, ScannersDoNotRepeatEachOther) {
  EXPECT_THAT(FindDoublings(lines_), IsEmpty());
}

// Not even where they give whole centimetres.
TEST_F(DoublingsTest, CoarseRangesAreNoCopies) {
  lines_.resize(1);
  Rig other = MakePaperRig();
  lines_.push_back(TurningRig(other).TakeLines()[1]);
  for (auto& of_scanner : lines_) {
    for (ScanLine& line : of_scanner) {
      for (float& range : line.ranges) range = std::round(range * 100.0F) / 100.0F;
    }
  }
  EXPECT_THAT(FindDoublings(lines_), IsEmpty());
}

TEST_F(DoublingsTest, AFilteredCopyIsFound) {
  lines_[2] = lines_[0];
  for (ScanLine& line : lines_[2]) {
    line.stamp_ns += 1'000'000;
    for (size_t beam = 0; beam < line.ranges.size(); ++beam) {
      if (beam % 3 == 0) line.ranges[beam] = std::numeric_limits<float>::quiet_NaN();
      if (beam % 7 == 0) line.ranges[beam] += 0.01F;
    }
  }
  const std::vector<Doubling> doublings = FindDoublings(lines_);
  ASSERT_THAT(doublings, SizeIs(1));
  EXPECT_EQ(doublings[0].original, 0u);
  EXPECT_EQ(doublings[0].copy, 2u);
  EXPECT_NEAR(doublings[0].share, 6.0 / 7.0, 0.02);
}

}  // namespace
}  // namespace plumbline
