#include "core/registration/spot_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace plumbline {
namespace {

TEST(SpotGrid, FindsAllWithinACellsSide) {
  constexpr double kCell = 0.4;  // m
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-3.0, 3.0);
  std::vector<WallSpot> spots;
  for (int i = 0; i < 500; ++i) {
    spots.push_back({{coordinate(random), coordinate(random)}, {1.0, 0.0}});
  }
  const SpotGrid grid(spots, kCell);
  ASSERT_EQ(grid.spots().size(), spots.size());
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d p(coordinate(random), coordinate(random));
    int num_found = 0;
    grid.ForEachNear(p, [&](const WallSpot& spot) {
      if ((spot.position - p).norm() <= kCell) ++num_found;
      EXPECT_LT((spot.position - p).lpNorm<Eigen::Infinity>(), 2.0 * kCell);
    });
    EXPECT_EQ(num_found, std::count_if(spots.begin(), spots.end(), [&](const WallSpot& spot) {
                return (spot.position - p).norm() <= kCell;
              }));
  }
}

TEST(SpotGrid, FindsNothingElsewhereAndInNone) {
  int num_found = 0;
  const auto count = [&](const WallSpot&) { ++num_found; };
  SpotGrid({{{-0.1, -0.1}, {1.0, 0.0}}}, 1.0).ForEachNear({5.0, 5.0}, count);
  SpotGrid({}, 1.0).ForEachNear({0.0, 0.0}, count);
  EXPECT_EQ(num_found, 0);
}

}  // namespace
}  // namespace plumbline
