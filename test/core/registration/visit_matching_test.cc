#include "core/registration/visit_matching.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test/core/registration/ring_way.h"

namespace plumbline {
namespace {

constexpr double kDegree = M_PI / 180.0;

// Two rounds without drift.
class VisitMatchingTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    way_ = new RingWay(110.0, 0.0);
    visits_ = new std::vector<Visit>(CutIntoVisits(way_->scans(), way_->trajectory()));
  }
  static void TearDownTestSuite() {
    delete visits_;
    delete way_;
  }

  static std::optional<VisitMatch> Match(const Visit& earlier,
                                         const Visit& later,
                                         const PlanarPose& guess) {
    return MatchVisits(VisitGrid(earlier), VisitSurface(earlier), later, guess, MatchWindow());
  }

  // The first visit, and the one of the second round that is nearest to it.
  static const Visit& First() { return (*visits_)[2]; }
  static const Visit& Later() {
    const Visit* nearest = nullptr;
    for (const Visit& visit : *visits_) {
      if (visit.way_m < 40.0) continue;
      const auto distance = [&](const Visit& v) {
        return (v.world_from_visit.position - First().world_from_visit.position).norm();
      };
      if (nearest == nullptr || distance(visit) < distance(*nearest)) nearest = &visit;
    }
    return *nearest;
  }

  static RingWay* way_;
  static std::vector<Visit>* visits_;
};

RingWay* VisitMatchingTest::way_ = nullptr;
std::vector<Visit>* VisitMatchingTest::visits_ = nullptr;

TEST_F(VisitMatchingTest, APlaceIsKnownAgain) {
  const PlanarPose truth = First().world_from_visit.Inverse() * Later().world_from_visit;
  PlanarPose guess = truth;
  guess.position += Eigen::Vector2d(1.4, -0.9);
  guess.heading += 8.0 * kDegree;
  const std::optional<VisitMatch> match = Match(First(), Later(), guess);
  ASSERT_TRUE(match);
  EXPECT_LT((match->earlier_from_later.position - truth.position).norm(), 0.02);
  EXPECT_NEAR(std::remainder(match->earlier_from_later.heading - truth.heading, 2.0 * M_PI),
              0.0,
              0.2 * kDegree);
  // The walls along the corridor hold it more firmly than its doors.
  const Eigen::Vector3d information = match->information.diagonal();
  EXPECT_GT(information.minCoeff(), 1.0 / (0.1 * 0.1));
  EXPECT_GT(information.y(), information.x());
}

TEST_F(VisitMatchingTest, AnotherPlaceIsNot) {
  Visit room;  // 7 m by 5 m, with a table's legs
  for (double along = 0.0; along < 1.0; along += 0.015) {
    for (const double side : {-1.0, 1.0}) {
      room.points.emplace_back(7.0 * along - 3.5, 2.5 * side);
      room.points.emplace_back(3.5 * side, 5.0 * along - 2.5);
    }
  }
  for (const Eigen::Vector2d& leg :
       std::vector<Eigen::Vector2d>{{1.0, 0.5}, {2.0, 0.5}, {1.0, -0.5}, {2.0, -0.5}}) {
    room.points.push_back(leg);
  }
  room.scanners.assign(room.points.size(), {-1.0, 0.0});
  EXPECT_TRUE(Match(room, room, PlanarPose()));
  EXPECT_FALSE(Match(First(), room, PlanarPose()));
  EXPECT_FALSE(Match(room, First(), PlanarPose()));
}

TEST_F(VisitMatchingTest, ABareCorridorLooksTheSameEverywhere) {
  Visit corridor;
  for (double x = -10.0; x < 10.0; x += 0.1) {
    for (const double y : {-1.0, 1.0}) {
      corridor.points.emplace_back(x, y);
      corridor.scanners.emplace_back(0.2 * x, 0.0);
    }
  }
  EXPECT_FALSE(Match(corridor, corridor, PlanarPose()));
  // One column tells where it is.
  for (double angle = 0.0; angle < M_PI; angle += 0.1) {
    for (double x : {-4.0, -1.5, 2.0, 5.0}) {
      corridor.points.emplace_back(x + 0.5 * std::cos(angle), 0.6 - 0.5 * std::sin(angle));
      corridor.scanners.emplace_back(x, 0.0);
    }
  }
  EXPECT_TRUE(Match(corridor, corridor, PlanarPose()));
}

TEST_F(VisitMatchingTest, LittleSeenIsNoPlace) {
  Visit little = Later();
  little.points.resize(20);
  little.scanners.resize(20);
  EXPECT_FALSE(
      Match(First(), little, First().world_from_visit.Inverse() * little.world_from_visit));
}

TEST_F(VisitMatchingTest, BoundsAreBounds) {
  const VisitGrid grid(First());
  for (double x = -6.0; x < 6.0; x += 0.13) {
    for (double y = -6.0; y < 6.0; y += 0.17) {
      for (int i = 0; i < VisitGrid::kCoarse; ++i) {
        for (int j = 0; j < VisitGrid::kCoarse; ++j) {
          const Eigen::Vector2d moved(x + VisitGrid::kCell * i, y + VisitGrid::kCell * j);
          EXPECT_GE(grid.BoundAt(grid.CellOf({x, y})), grid.At(grid.CellOf(moved)));
        }
      }
    }
  }
}

}  // namespace
}  // namespace plumbline
