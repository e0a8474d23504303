#include "core/judging/topic_survey.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/geometry/angles.h"

namespace plumbline {
namespace {

constexpr int kNumBeams = 181;
constexpr double kNoise = 0.02;  // m
constexpr int64_t kStartNs = 1'600'000'000'000'000'000;

// A scanner in the middle of a square room of 4 m, ten lines a second.
class TopicSurveyTest : public testing::Test {
 protected:
  ScanMessage Next() {
    ScanMessage message;
    message.line.stamp_ns = kStartNs + 100'000'000 * num_lines_++;
    message.receipt_ns = message.line.stamp_ns;
    message.line.angle_min = -90.0 * kRadiansPerDegree;
    message.line.angle_increment = 1.0 * kRadiansPerDegree;
    message.line.time_increment_s = 1e-4;
    std::normal_distribution<double> noise(0.0, kNoise);
    for (int beam = 0; beam < kNumBeams; ++beam) {
      const double angle = message.line.BeamAngle(beam);
      const double side = std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
      message.line.ranges.push_back(static_cast<float>(2.0 / side + noise(random_)));
    }
    return message;
  }
  TopicSurvey Survey(const std::vector<ScanMessage>& messages,
                     const RangeLimits* limits = nullptr) {
    TopicSurveyor surveyor(limits);
    for (const ScanMessage& message : messages) surveyor.Add(message);
    const int64_t start_ns = surveyor.Order();
    return surveyor.Finish({"/scan", "sensor_msgs/LaserScan", true, 0}, start_ns);
  }
  std::vector<ScanMessage> Take(int num_lines) {
    std::vector<ScanMessage> messages;
    for (int i = 0; i < num_lines; ++i) messages.push_back(Next());
    return messages;
  }

  int64_t num_lines_ = 0;
  std::mt19937 random_{1};
};

TEST_F(TopicSurveyTest, CountsAGoodScanner) {
  const TopicSurvey survey = Survey(Take(100));
  EXPECT_EQ(survey.name, "/scan");
  EXPECT_EQ(survey.stamps.size(), 100u);
  EXPECT_NEAR(survey.period_s, 0.1, 1e-9);
  EXPECT_EQ(survey.num_beams, kNumBeams);
  EXPECT_EQ(survey.num_returns, 100 * kNumBeams);
  EXPECT_EQ(survey.metres_per_unit, 1.0);
  EXPECT_NEAR(survey.noise_m, kNoise, 0.1 * kNoise);
  EXPECT_NEAR(survey.RangeQuantile(0.5), 2.25, 0.15);
  ASSERT_EQ(survey.seconds.size(), 10u);
  EXPECT_EQ(survey.seconds[3].num_lines, 10);
  EXPECT_EQ(survey.seconds[3].num_repeated, 0);
  EXPECT_GT(survey.seconds[3].num_straight,
            0.9 * static_cast<double>(survey.seconds[3].num_triples));
}

TEST_F(TopicSurveyTest, TellsMillimetresAndCentimetres) {
  for (const double unit : {1e-3, 1e-2}) {
    std::vector<ScanMessage> messages = Take(30);
    for (ScanMessage& message : messages) {
      for (float& range : message.line.ranges) range /= static_cast<float>(unit);
    }
    const TopicSurvey survey = Survey(messages);
    EXPECT_EQ(survey.metres_per_unit, unit);
    EXPECT_EQ(survey.num_returns, 30 * kNumBeams);
    EXPECT_NEAR(survey.noise_m, kNoise, 0.2 * kNoise);
  }
}

TEST_F(TopicSurveyTest, SortsWhatIsNoReturn) {
  std::vector<ScanMessage> messages = Take(100);
  for (ScanMessage& message : messages) {
    message.line.ranges[0] = std::numeric_limits<float>::quiet_NaN();
    message.line.ranges[1] = std::numeric_limits<float>::infinity();
    message.line.ranges[2] = 0.0F;
    message.line.ranges[3] = 0.01F;
    for (size_t beam = 4; beam < 14; ++beam) message.line.ranges[beam] = 11.0F;
  }
  const TopicSurvey survey = Survey(messages);
  EXPECT_EQ(survey.num_nan, 100);
  EXPECT_EQ(survey.num_infinite, 100);
  EXPECT_EQ(survey.num_zero, 100);
  EXPECT_EQ(survey.num_too_near, 100);
  EXPECT_EQ(survey.num_at_limit, 1000);
  EXPECT_EQ(survey.num_returns, 100 * (kNumBeams - 14));
  EXPECT_LT(survey.limits.max_m, 11.0);
  EXPECT_EQ(survey.beams[5].num_returns, 0);
  EXPECT_EQ(survey.beams[20].num_returns, 100);
}

TEST_F(TopicSurveyTest, HoldsTheRigFilesLimits) {
  const RangeLimits limits = {0.1, 2.5};
  const TopicSurvey survey = Survey(Take(10), &limits);
  EXPECT_GT(survey.num_too_far, 100);
  EXPECT_EQ(survey.num_returns + survey.num_too_far, survey.num_ranges);
}

TEST_F(TopicSurveyTest, CountsRepeatedLinesAndNoise) {
  std::vector<ScanMessage> messages = Take(30);
  std::uniform_real_distribution<float> any(0.1F, 30.0F);
  for (size_t i = 10; i < 30; ++i) {
    if (i < 20) {
      messages[i].line.ranges = messages[9].line.ranges;
    } else {
      for (float& range : messages[i].line.ranges) range = any(random_);
    }
  }
  const TopicSurvey survey = Survey(messages);
  EXPECT_EQ(survey.seconds[0].num_repeated, 0);
  EXPECT_EQ(survey.seconds[1].num_repeated, 10);
  EXPECT_LT(survey.seconds[2].num_straight,
            0.1 * static_cast<double>(survey.seconds[2].num_triples));
}

TEST_F(TopicSurveyTest, CountsLinesThatAreUnlikeMost) {
  std::vector<ScanMessage> messages = Take(5);
  messages[0].line.ranges.resize(10);
  messages[3].usable = false;
  const TopicSurvey survey = Survey(messages);
  EXPECT_EQ(survey.num_beams, kNumBeams);
  EXPECT_EQ(survey.num_other_layouts, 1);
  EXPECT_EQ(survey.passed_over.unusable.count, 1);
  EXPECT_EQ(survey.stamps.size(), 4u);
}

TEST_F(TopicSurveyTest, AnEmptyTopicHasNoFigures) {
  const TopicSurvey survey = Survey({});
  EXPECT_EQ(survey.period_s, 0.0);
  EXPECT_EQ(survey.noise_m, 0.0);
  EXPECT_EQ(survey.RangeQuantile(0.5), 0.0);
}

TEST_F(TopicSurveyTest, ClocksThatWereNotSetCostNoMemory) {
  std::vector<ScanMessage> messages = Take(100);
  messages[0].line.stamp_ns = 0;
  messages[0].receipt_ns = 0;
  messages[50].receipt_ns = 0;
  const TopicSurvey survey = Survey(messages);
  EXPECT_EQ(survey.passed_over.apart.count, 1);
  EXPECT_EQ(survey.num_receipts_off, 1);
  EXPECT_EQ(survey.stamps.size(), 99u);
  EXPECT_EQ(survey.stamps[49].receipt_ns, survey.stamps[49].stamp_ns);
  EXPECT_EQ(survey.seconds.size(), 10u);
  EXPECT_EQ(survey.seconds.back().second, 9);
}

TEST_F(TopicSurveyTest, AGapOfYearsHoldsNoSeconds) {
  std::vector<ScanMessage> messages = Take(100);
  for (size_t i = 0; i < 50; ++i) {
    messages[i].line.stamp_ns -= kStartNs;
    messages[i].receipt_ns -= kStartNs;
  }
  const TopicSurvey survey = Survey(messages);
  EXPECT_EQ(survey.stamps.size(), 100u);
  EXPECT_EQ(survey.seconds.size(), 10u);
  EXPECT_GT(survey.seconds.back().second, 1'500'000'000);
}

TEST_F(TopicSurveyTest, MessagesOutOfTurnAreSorted) {
  std::vector<ScanMessage> messages = Take(100);
  for (size_t i = 0; i < 100; i += 10) messages[i].receipt_ns += 150'000'000;
  const TopicSurvey survey = Survey(messages);
  EXPECT_EQ(survey.stamps.size(), 100u);
  EXPECT_EQ(survey.num_out_of_turn, 10);
  EXPECT_NEAR(survey.period_s, 0.1, 1e-9);
}

TEST_F(TopicSurveyTest, TellsScannersThatTakeTurns) {
  std::vector<ScanMessage> messages = Take(60);
  EXPECT_EQ(Survey(messages).num_alternating, 0);
  for (size_t i = 0; i < messages.size(); i += 2) {
    for (float& range : messages[i].line.ranges) range += 1.0F;
  }
  const TopicSurvey survey = Survey(messages);
  EXPECT_EQ(survey.num_compared, 58);
  EXPECT_EQ(survey.num_alternating, 58);
}

TEST_F(TopicSurveyTest, KeepsWhyTheFirstUnusableLineIsOne) {
  std::vector<ScanMessage> messages = Take(5);
  for (const int i : {1, 3}) {
    messages[static_cast<size_t>(i)].usable = false;
    messages[static_cast<size_t>(i)].unusable_reason = "reason " + std::to_string(i);
  }
  EXPECT_EQ(Survey(messages).unusable_reason, "reason 1");
}

}  // namespace
}  // namespace plumbline
