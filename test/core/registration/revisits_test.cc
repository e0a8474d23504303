#include "core/registration/revisits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/batch/drift_correction.h"
#include "test/core/registration/ring_way.h"

namespace plumbline {
namespace {

constexpr double kDegree = M_PI / 180.0;

struct Errors {
  double position_m = 0.0;
  double heading = 0.0;  // rad
};

// The largest errors of poses at the visits' times.
Errors LargestErrors(const RingWay& way,
                     const std::vector<Visit>& visits,
                     const std::vector<PlanarPose>& poses) {
  Errors largest;
  for (size_t i = 0; i < visits.size(); ++i) {
    const PlanarPose truth = way.TruePose(visits[i].time_ns);
    largest.position_m =
        std::max(largest.position_m, (poses[i].position - truth.position).norm());
    largest.heading =
        std::max(largest.heading,
                 std::abs(std::remainder(poses[i].heading - truth.heading, 2.0 * M_PI)));
  }
  return largest;
}

TEST(Revisits, DriftIsSpreadOverTheWay) {
  const RingWay way(100.0, 0.05 * kDegree);
  const std::vector<Visit> visits = CutIntoVisits(way.scans(), way.trajectory());
  std::vector<PlanarPose> believed;
  for (const Visit& visit : visits) believed.push_back(visit.world_from_visit);
  ASSERT_GT(LargestErrors(way, visits, believed).position_m, 0.8);

  const PlacedVisits placed = PlaceVisits(visits);
  EXPECT_GT(placed.closures.size(), 20u);
  EXPECT_EQ(placed.num_contradicted, 0);
  EXPECT_FALSE(Hold(placed.closures, visits));
  const Errors errors = LargestErrors(way, visits, placed.world_from_visit);
  EXPECT_LT(errors.position_m, 0.3);
  EXPECT_LT(errors.heading, 2.0 * kDegree);

  // The trajectory follows, and what lies between two visits moves no differently.
  Trajectory bent = way.trajectory();
  BendTrajectory(way.scans(), visits, placed.world_from_visit, &bent);
  for (size_t i = 0; i < visits.size(); ++i) {
    const PlanarPose pose = FromAbove(bent.WorldFromBody(visits[i].time_ns));
    EXPECT_LT((pose.position - placed.world_from_visit[i].position).norm(), 0.01);
    EXPECT_NEAR(std::remainder(pose.heading - placed.world_from_visit[i].heading, 2.0 * M_PI),
                0.0,
                0.2 * kDegree);
  }
  for (int64_t time_ns = 0; time_ns < bent.end_ns(); time_ns += 100'000'000) {
    const PlanarPose pose = FromAbove(bent.WorldFromBody(time_ns));
    EXPECT_LT((pose.position - way.TruePose(time_ns).position).norm(), 0.35) << time_ns;
  }
}

// A turn of 35 degrees that nobody has noticed takes the rig farther off than drift does.
TEST(Revisits, AfterASlipPlacesAreFoundFromFarAway) {
  const RingWay way(130.0, 0.0, 35.0 * kDegree);
  const std::vector<Visit> visits = CutIntoVisits(way.scans(), way.trajectory());
  std::vector<PlanarPose> believed;
  for (const Visit& visit : visits) believed.push_back(visit.world_from_visit);
  ASSERT_GT(LargestErrors(way, visits, believed).position_m, 8.0);
  const Odometry wheels = way.wheels();
  const PlacedVisits placed = PlaceVisits(visits, &wheels);
  EXPECT_GT(placed.closures.size(), 20u);
  const Errors errors = LargestErrors(way, visits, placed.world_from_visit);
  EXPECT_LT(errors.position_m, 0.5);
  EXPECT_LT(errors.heading, 3.0 * kDegree);
}

// The rig comes round again with a drift that is too large for its places to be found, and
// falls to 2 m: what later places say of it brings earlier ones within reach.
TEST(Revisits, PlacesAreAskedAgainOnceTheDriftIsKnown) {
  const RingWay way(100.0, 0.0);
  std::vector<Visit> visits = CutIntoVisits(way.scans(), way.trajectory());
  for (Visit& visit : visits) {
    const double rise = 4.6 * std::min(1.0, visit.way_m / 54.0);
    const double fall = 2.6 * std::clamp((visit.way_m - 54.0) / 26.0, 0.0, 1.0);
    visit.world_from_visit.position.y() += rise - fall;
  }
  const PlacedVisits placed = PlaceVisits(visits);
  const auto num_early = std::count_if(
      placed.closures.begin(), placed.closures.end(), [&](const PoseGraphEdge& closure) {
        return visits[closure.to].way_m < 59.0;
      });
  EXPECT_GE(num_early, 6);
}

TEST(Revisits, WithoutDriftNothingIsBent) {
  const RingWay way(90.0, 0.0);
  const std::vector<Visit> visits = CutIntoVisits(way.scans(), way.trajectory());
  const PlacedVisits placed = PlaceVisits(visits);
  EXPECT_GT(placed.closures.size(), 10u);
  EXPECT_TRUE(Hold(placed.closures, visits));
}

TEST(Revisits, OneRoundMeetsNothingAgain) {
  const RingWay way(40.0, 0.05 * kDegree);
  EXPECT_TRUE(PlaceVisits(CutIntoVisits(way.scans(), way.trajectory())).closures.empty());
}

TEST(Revisits, NoVisits) { EXPECT_TRUE(PlaceVisits({}).world_from_visit.empty()); }

}  // namespace
}  // namespace plumbline
