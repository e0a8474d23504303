#include "apps/progress.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

ProgressState State(double share_done, const char* stage, double recording_s) {
  ProgressState state(share_done);
  state.stage = stage;
  state.recording_s = recording_s;
  return state;
}

TEST(ProgressLineTest, SaysStageShareSpeedAndTimeLeft) {
  // A quarter in 10 s makes 40 s for all: 100 s of recording at 2.5 times real time.
  EXPECT_EQ(ProgressLine("map", State(0.25, "following", 100.0), 10.0),
            "map: following,  25 %, 2.5 times real time, 30 s to go");
}

TEST(ProgressLineTest, LeavesOutWhatIsNotKnown) {
  EXPECT_EQ(ProgressLine("bound", 0.5, 4.0), "bound:  50 %, 4 s to go");
  EXPECT_EQ(ProgressLine("map", State(0.0, "following", 100.0), 1.0), "map: following,   0 %");
  EXPECT_EQ(ProgressLine("map", State(0.1, "following", 100.0), 0.01),
            "map: following,  10 %");
}

TEST(ProgressLineTest, LongTimesAreInMinutesAndHours) {
  EXPECT_EQ(ProgressLine("bound", 0.5, 99.0), "bound:  50 %, 99 s to go");
  EXPECT_EQ(ProgressLine("bound", 0.5, 200.0), "bound:  50 %, 3 min 20 s to go");
  EXPECT_EQ(ProgressLine("bound", 0.5, 7500.0), "bound:  50 %, 2 h 5 min to go");
}

TEST(ProgressLineTest, AShareAloneIsAState) {
  const ProgressCallback callback = [](double share) { EXPECT_EQ(share, 0.75); };
  callback(0.75);
}

}  // namespace
}  // namespace plumbline
