#include "core/recording/segment_joiner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

using ::testing::Each;
using ::testing::Field;
using ::testing::SizeIs;

constexpr int64_t kStart = 1'600'000'000'000'000'000;
constexpr double kDegree = M_PI / 180.0;

// A revolution of 270 beams, 1 degree and 0.1 ms apart, in segments.
std::vector<ScanLineMessage> Segments(int revolution, uint32_t num_beams) {
  std::vector<ScanLineMessage> segments;
  for (uint32_t first = 0; first < 270; first += num_beams) {
    ScanLineMessage segment;
    segment.stamp_ns = kStart + 40'000'000 * int64_t{revolution} + 100'000 * int64_t{first};
    segment.frame_id = "laser";
    segment.angle_min = static_cast<float>((-135.0 + first) * kDegree);
    segment.angle_increment = static_cast<float>(kDegree);
    segment.time_increment = 1e-4f;
    segment.num_beams = num_beams;
    for (uint32_t beam = 0; beam < num_beams; ++beam) {
      segment.ranges.push_back(static_cast<float>(first + beam));
    }
    segments.push_back(segment);
  }
  return segments;
}

struct Joined {
  size_t num_parts = 0;
  ScanLineMessage line;
};

std::vector<Joined> Join(const std::vector<ScanLineMessage>& messages) {
  std::vector<Joined> joined;
  SegmentJoiner joiner([&](const std::vector<MessageRef>& parts, const ScanLineMessage& line) {
    joined.push_back({parts.size(), line});
  });
  MessageRef where;
  for (const ScanLineMessage& message : messages) {
    joiner.Add(where, message);
    ++where.begin;
  }
  joiner.Finish();
  return joined;
}

std::vector<ScanLineMessage> Revolutions(int count, uint32_t num_beams) {
  std::vector<ScanLineMessage> messages;
  for (int i = 0; i < count; ++i) {
    for (const ScanLineMessage& segment : Segments(i, num_beams)) messages.push_back(segment);
  }
  return messages;
}

TEST(SegmentJoinerTest, SegmentsOfAnySizeBecomeRevolutions) {
  const ScanLineMessage whole = Segments(0, 270).front();
  for (const uint32_t num_beams : {30u, 90u, 135u}) {
    const std::vector<Joined> joined = Join(Revolutions(3, num_beams));
    // The first segment is a line of its own: what follows was not yet known.
    ASSERT_THAT(joined, SizeIs(4)) << num_beams;
    EXPECT_EQ(joined[0].line.num_beams, num_beams);
    EXPECT_EQ(joined[1].line.num_beams, 270u - num_beams);
    for (const size_t i : {size_t{2}, size_t{3}}) {
      EXPECT_EQ(joined[i].num_parts, 270 / num_beams);
      EXPECT_EQ(joined[i].line.num_beams, 270u);
      EXPECT_EQ(joined[i].line.stamp_ns, kStart + 40'000'000 * static_cast<int64_t>(i - 1));
      EXPECT_EQ(joined[i].line.angle_min, whole.angle_min);
      EXPECT_EQ(joined[i].line.ranges, whole.ranges);
    }
  }
}

TEST(SegmentJoinerTest, WholeRevolutionsStayAsTheyAre) {
  const std::vector<Joined> joined = Join(Revolutions(4, 270));
  ASSERT_THAT(joined, SizeIs(4));
  EXPECT_THAT(joined, Each(Field(&Joined::num_parts, size_t{1})));
}

TEST(SegmentJoinerTest, AFullTurnDoesNotGoOnInTheNext) {
  std::vector<ScanLineMessage> messages = Revolutions(4, 270);
  for (size_t i = 0; i < messages.size(); ++i) {
    messages[i].angle_increment = static_cast<float>(2.0 * M_PI / 270.0);
    messages[i].angle_min = static_cast<float>(-M_PI);
  }
  EXPECT_THAT(Join(messages), SizeIs(4));
}

TEST(SegmentJoinerTest, ALostSegmentHasNoReturn) {
  std::vector<ScanLineMessage> messages = Revolutions(2, 30);
  messages.erase(messages.begin() + 9 + 4);
  const std::vector<Joined> joined = Join(messages);
  ASSERT_THAT(joined, SizeIs(3));
  const std::vector<float>& ranges = joined[2].line.ranges;
  ASSERT_THAT(ranges, SizeIs(270));
  EXPECT_EQ(ranges[119], 119.0f);
  EXPECT_TRUE(std::isnan(ranges[120]));
  EXPECT_TRUE(std::isnan(ranges[149]));
  EXPECT_EQ(ranges[150], 150.0f);
}

TEST(SegmentJoinerTest, ALostRevolutionIsNotJoinedWithTheNext) {
  std::vector<ScanLineMessage> messages = Revolutions(3, 90);
  messages.erase(messages.begin() + 4, messages.begin() + 7);
  const std::vector<Joined> joined = Join(messages);
  ASSERT_THAT(joined, SizeIs(4));
  EXPECT_EQ(joined[2].line.num_beams, 90u);
  EXPECT_EQ(joined[3].line.num_beams, 180u);
}

TEST(SegmentJoinerTest, StampsSayHowFastItTurnsWhereIncrementsDoNot) {
  std::vector<ScanLineMessage> messages = Revolutions(2, 30);
  for (ScanLineMessage& message : messages) message.time_increment = 0.0f;
  const std::vector<Joined> joined = Join(messages);
  ASSERT_THAT(joined, SizeIs(3));
  EXPECT_NEAR(joined[2].line.time_increment, 1e-4f, 1e-9f);
}

TEST(SegmentJoinerTest, ScannersOfDifferentFramesAreNotJoined) {
  std::vector<ScanLineMessage> messages = Segments(0, 135);
  messages[1].frame_id = "other";
  EXPECT_THAT(Join(messages), SizeIs(2));
}

TEST(SegmentJoinerTest, ABeamThatTwoSegmentsShareIsTakenOnce) {
  std::vector<ScanLineMessage> segments = Segments(0, 90);
  segments[1].angle_min -= segments[1].angle_increment;
  segments[1].ranges.insert(segments[1].ranges.begin(), 89.0f);
  segments[1].stamp_ns -= 100'000;
  ++segments[1].num_beams;
  ScanLineMessage line = segments[0];
  ASSERT_TRUE(AppendSegment(segments[1], &line));
  ASSERT_TRUE(AppendSegment(segments[2], &line));
  EXPECT_EQ(line.num_beams, 270u);
  EXPECT_EQ(line.ranges, Segments(0, 270).front().ranges);
}

}  // namespace
}  // namespace plumbline
