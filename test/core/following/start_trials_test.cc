#include "core/following/start_trials.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "core/util/time.h"
#include "test/testing/room_walk.h"

namespace plumbline {
namespace {

using Trials = std::vector<std::vector<ExplainedPoints>>;

// A trial of so many scans, each of which explains so many of 100 points.
std::vector<ExplainedPoints> Explains(int num_explained, size_t num_scans) {
  return std::vector<ExplainedPoints>(num_scans, {100, num_explained});
}

TEST(EarliestGoodTrialTest, TakesTheFirstOneUnlessALaterOneExplainsClearlyMore) {
  EXPECT_EQ(EarliestGoodTrial({Explains(90, 80)}, 20), 0U);
  EXPECT_EQ(EarliestGoodTrial({Explains(90, 80), Explains(92, 60), Explains(91, 40)}, 20), 0U);
  EXPECT_EQ(EarliestGoodTrial({Explains(60, 80), Explains(92, 60), Explains(94, 40)}, 20), 1U);
  EXPECT_EQ(EarliestGoodTrial({Explains(60, 80), Explains(55, 60), Explains(94, 40)}, 20), 2U);
}

TEST(EarliestGoodTrialTest, ComparesTheSameScans) {
  // The first scans show what no map explains: a later start did not have to.
  std::vector<ExplainedPoints> first = Explains(10, 30);
  const std::vector<ExplainedPoints> rest = Explains(90, 50);
  first.insert(first.end(), rest.begin(), rest.end());
  EXPECT_EQ(EarliestGoodTrial({first, Explains(90, 60)}, 20), 0U);
  // What a start explains while it still settles does not count.
  std::vector<ExplainedPoints> settling = Explains(100, 20);
  const std::vector<ExplainedPoints> astray = Explains(50, 40);
  settling.insert(settling.end(), astray.begin(), astray.end());
  EXPECT_EQ(EarliestGoodTrial({Explains(80, 80), settling}, 20), 0U);
  // One that ends within that time is not compared.
  EXPECT_EQ(EarliestGoodTrial({Explains(10, 80), Explains(100, 20)}, 20), 0U);
}

class StartTrialsTest : public testing::Test {
 protected:
  // Offers scans until the start is decided, and returns the start taken.
  FollowedStart Decide() {
    while (true) {
      const Scan scan = walk_.Take();
      Offer(scan);
      if (trials_.IsDecided(Seconds(scan))) return trials_.Take();
    }
  }
  void Offer(const Scan& scan) {
    trials_.Follow(scan);
    if (!trials_.WantsStart(Seconds(scan))) return;
    auto follower =
        std::make_unique<HypothesisFollower>(walk_.rig(), false, options_, RoomWalk::kPeriod);
    if (follower->Start(scan)) trials_.Add(std::move(follower), Seconds(scan));
  }
  static double Seconds(const Scan& scan) {
    return SecondsBetween(RoomWalk::kStartNs, scan.start_ns);
  }

  MapperOptions options_;
  RoomWalk walk_{Eigen::Vector3d(0.4, -0.3, 0.0)};
  StartTrials trials_;
};

TEST_F(StartTrialsTest, StaysWithAGoodFirstScan) {
  const FollowedStart start = Decide();
  EXPECT_EQ(start.start_s, 0.0);
  EXPECT_TRUE(start.lost.empty());
  EXPECT_TRUE(trials_.empty());
  // It has followed every scan since, and all that it saw is explained.
  EXPECT_NEAR(static_cast<double>(start.follower->follower().scan_times_ns().size()),
              StartTrials::kSureAfterS / RoomWalk::kPeriod,
              2.0);
}

TEST_F(StartTrialsTest, EndsAtOnceWhereNoneCanFollow) {
  Offer(walk_.Take());
  ASSERT_FALSE(trials_.empty());
  double now_s = 0.0;
  while (!trials_.IsDecided(now_s)) {
    const Scan blind = walk_.TakeBlind();
    now_s = Seconds(blind);
    trials_.Follow(blind);
  }
  EXPECT_LT(now_s, StartTrials::kDurationS);
  EXPECT_FALSE(trials_.Take().lost.empty());
}

}  // namespace
}  // namespace plumbline
