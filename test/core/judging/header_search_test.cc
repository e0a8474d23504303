#include "core/judging/header_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/geometry/angles.h"
#include "core/judging/mounting_search.h"
#include "test/core/judging/turning_rig.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// The paper's rig takes the lines; each test changes their headers.
class HeaderSearchTest : public testing::Test {
 protected:
  std::optional<OtherHeader> Find() const {
    std::vector<std::vector<SampledLine>> sample;
    std::vector<TopicSurvey> topics;
    for (const std::vector<ScanLine>& lines : lines_) {
      sample.push_back(SegmentSample(lines, SixWalls::kRangeNoise));
      TopicSurvey topic;
      topic.num_beams = lines[0].num_beams();
      topic.angle_increment = lines[0].angle_increment;
      topic.time_increment_s = lines[0].time_increment_s;
      topic.period_s = 1.0 / TurningRig::kRate;
      topics.push_back(topic);
    }
    return FindOtherHeader(sample, topics, AsRigFileSays(rig_, {0, 1, 2}), rig_.scanners);
  }
  static std::vector<std::string> NamesOf(const OtherHeader& other) {
    std::vector<std::string> names;
    for (const Scanner& scanner : other.scanners) names.push_back(scanner.name);
    return names;
  }
  template <typename Change>
  void ChangeAll(const Change& change) {
    for (std::vector<ScanLine>& lines : lines_) {
      for (ScanLine& line : lines) change(&line);
    }
  }

  Rig rig_ = MakePaperRig();
  std::vector<std::vector<ScanLine>> lines_ = TurningRig(rig_).TakeLines();
};

TEST_F(HeaderSearchTest, RightHeadersStay) { EXPECT_FALSE(Find()); }

TEST_F(HeaderSearchTest, NamesBeamsWithoutTimes) {
  const double time_increment_s = lines_[0][0].time_increment_s;
  ChangeAll([](ScanLine* line) { line->time_increment_s = 0.0; });
  const std::optional<OtherHeader> other = Find();
  ASSERT_TRUE(other);
  EXPECT_THAT(other->words, HasSubstr("time_increment is 0: the scanner turns once"));
  EXPECT_THAT(NamesOf(*other), ElementsAre("scanner0", "scanner1", "scanner2"));
  const Rig stated = WithHeaders(rig_, *other);
  EXPECT_NEAR(*stated.scanners[2].time_increment_s, time_increment_s, 1e-6);
  EXPECT_NEAR(other->sample[1][0].time_increment_s, time_increment_s, 1e-6);
  EXPECT_GT(other->share_so, other->share_as_stated);
}

TEST_F(HeaderSearchTest, NamesAnglesThatAreTooFarApart) {
  ChangeAll([](ScanLine* line) {
    line->angle_increment *= line->num_beams() / (line->num_beams() - 1.0);
    line->directions = nullptr;
  });
  const std::optional<OtherHeader> other = Find();
  ASSERT_TRUE(other);
  EXPECT_THAT(other->words, HasSubstr("angle_increment is too large"));
}

TEST_F(HeaderSearchTest, NamesStampsOfTheLastBeam) {
  const double line_s = (lines_[1][0].num_beams() - 1) * lines_[1][0].time_increment_s;
  for (ScanLine& line : lines_[1]) line.stamp_ns += NanosecondsFromSeconds(line_s);
  const std::optional<OtherHeader> other = Find();
  ASSERT_TRUE(other);
  EXPECT_THAT(other->words, HasSubstr("stamps are those of the last beam"));
  EXPECT_THAT(NamesOf(*other), ElementsAre("scanner1"));
  const Rig stated = WithHeaders(rig_, *other);
  EXPECT_NEAR(stated.scanners[1].time_offset_s, -line_s, 1e-6);
  EXPECT_EQ(stated.scanners[0].time_offset_s, 0.0);
}

TEST_F(HeaderSearchTest, NamesBeamsThatAreTurnedRound) {
  ChangeAll([](ScanLine* line) {
    std::reverse(line->ranges.begin(), line->ranges.end());
    line->angle_min += (line->num_beams() - 1) * line->angle_increment;
    line->angle_increment = -line->angle_increment;
    line->directions = nullptr;
  });
  const std::optional<OtherHeader> other = Find();
  ASSERT_TRUE(other);
  EXPECT_THAT(other->words, HasSubstr("the other way round"));
  EXPECT_THAT(other->advice, HasSubstr("time_increment_s: -0.0001"));
}

}  // namespace
}  // namespace plumbline
