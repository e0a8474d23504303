#include "core/sensor/scan_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "test/core/sensor/recording_fixture.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr int64_t kSecond = 1'000'000'000;

// Lines of one scanner every 25 ms, received 3 ms after their stamps.
std::vector<ScanStamp> Lines(int scanner_index, int num_lines) {
  std::vector<ScanStamp> lines;
  for (int i = 0; i < num_lines; ++i) {
    const int64_t stamp_ns = kStart + i * kPeriod;
    lines.push_back({stamp_ns, scanner_index, true, stamp_ns + 3 * kMillisecond});
  }
  return lines;
}

bool AreSorted(const ScanOrder& order, const std::vector<ScanStamp>& stamps) {
  return std::is_sorted(
      order.positions.begin(), order.positions.end(), [&](size_t a, size_t b) {
        return stamps[a].stamp_ns < stamps[b].stamp_ns;
      });
}

TEST(ScanOrderTest, MessagesThatWereHeldUpAreSortedIn) {
  std::vector<ScanStamp> lines = Lines(0, 400);
  std::mt19937 random(1);
  for (ScanStamp& line : lines) {
    line.receipt_ns += static_cast<int64_t>(random() % 90) * kMillisecond;
  }
  std::stable_sort(lines.begin(), lines.end(), [](const auto& a, const auto& b) {
    return a.receipt_ns < b.receipt_ns;
  });
  const ScanOrder order = OrderScanLines(MakeRig({"top"}), lines);
  EXPECT_THAT(order.positions, SizeIs(400));
  EXPECT_TRUE(AreSorted(order, lines));
  EXPECT_THAT(order.warnings, IsEmpty());
}

TEST(ScanOrderTest, MessagesInAnyOrderAreSorted) {
  std::vector<ScanStamp> lines = Lines(0, 300);
  std::shuffle(lines.begin(), lines.end(), std::mt19937(2));
  const ScanOrder order = OrderScanLines(MakeRig({"top"}), lines);
  EXPECT_THAT(order.positions, SizeIs(300));
  EXPECT_TRUE(AreSorted(order, lines));
}

TEST(ScanOrderTest, AClockThatIsSetBackDoesNotMixTwoTimes) {
  std::vector<ScanStamp> lines = Lines(0, 400);
  for (size_t i = 200; i < lines.size(); ++i)
    lines[i].stamp_ns -= 2 * kSecond + 10 * kMillisecond;
  const ScanOrder order = OrderScanLines(MakeRig({"top"}), lines);
  ASSERT_FALSE(order.positions.empty());
  for (size_t i = 1; i < order.positions.size(); ++i) {
    const int64_t step_ns =
        lines[order.positions[i]].stamp_ns - lines[order.positions[i - 1]].stamp_ns;
    EXPECT_GT(step_ns, kPeriod / 2);
  }
  EXPECT_THAT(order.warnings, ElementsAre(HasSubstr("stamps that jump against the others")));
}

// The clock is not yet set for so many lines at the beginning.
TEST(ScanOrderTest, LinesBeforeTheClockWasSetArePassedOver) {
  for (const int num_unset : {1, 3, 12}) {
    std::vector<ScanStamp> lines = Lines(0, 400);
    for (int i = 0; i < num_unset; ++i) lines[static_cast<size_t>(i)].stamp_ns = i * kPeriod;
    const ScanOrder order = OrderScanLines(MakeRig({"top"}), lines);
    EXPECT_THAT(order.positions, SizeIs(400 - num_unset));
    ASSERT_THAT(order.warnings, SizeIs(1));
    EXPECT_THAT(order.warnings[0], HasSubstr("time stamps that lie apart from all others"));
    EXPECT_THAT(order.warnings[0], HasSubstr("1970-01-01 00:00:00 UTC"));
  }
}

TEST(ScanOrderTest, AStampOfAnotherYearIsPassedOverInAShortRecording) {
  std::vector<ScanStamp> lines = Lines(0, 20);
  lines[0].stamp_ns = lines[0].receipt_ns = 0;
  const ScanOrder order = OrderScanLines(MakeRig({"top"}), lines);
  EXPECT_THAT(order.positions, SizeIs(19));
  EXPECT_THAT(order.warnings, ElementsAre(HasSubstr("1 scan line passed over")));
}

TEST(ScanOrderTest, LinesOfAnotherYearArePassedOverWhereverTheyStand) {
  for (const size_t at : {size_t{0}, size_t{200}, size_t{399}}) {
    for (const int64_t away_s : {-600, 90, 86'400 * 365}) {
      std::vector<ScanStamp> lines = Lines(0, 400);
      lines[at].stamp_ns += away_s * kSecond;
      const ScanOrder order = OrderScanLines(MakeRig({"top"}), lines);
      EXPECT_THAT(order.positions, SizeIs(399)) << at << ' ' << away_s;
      EXPECT_THAT(order.warnings, ElementsAre(HasSubstr("1 scan line passed over")));
    }
  }
}

TEST(ScanOrderTest, AScannerWithoutAClockIsPassedOverWithItsTopic) {
  std::vector<ScanStamp> lines = Lines(0, 400);
  for (ScanStamp line : Lines(1, 400)) {
    line.stamp_ns = 0;
    lines.push_back(line);
  }
  const ScanOrder order = OrderScanLines(MakeRig({"top", "left"}), lines);
  EXPECT_THAT(order.positions, SizeIs(400));
  EXPECT_THAT(order.warnings, testing::Contains(HasSubstr("'left' has no usable scan line")));
}

TEST(ScanOrderTest, APauseThatTheRecorderConfirmsIsKept) {
  std::vector<ScanStamp> lines = Lines(0, 400);
  for (size_t i = 10; i < lines.size(); ++i) {
    lines[i].stamp_ns += 60 * kSecond;
    lines[i].receipt_ns += 60 * kSecond;
  }
  const ScanOrder order = OrderScanLines(MakeRig({"top"}), lines);
  EXPECT_THAT(order.positions, SizeIs(400));
  EXPECT_THAT(order.warnings, ElementsAre(HasSubstr("no scanner delivered anything for 60")));
}

}  // namespace
}  // namespace plumbline
