#include "core/visibility/place_deviations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace plumbline {
namespace {

constexpr double kUnevenness = 0.004;
constexpr double kNoiseVariance = 1e-8;  // of a place, m^2

// Places along a wall of 4 m, a quarter of a metre each: the wall's parameters are its distance
// and its heading.
SurfacePlaces Wall(const std::vector<double>& values_m) {
  SurfacePlaces places;
  for (size_t i = 0; i < values_m.size(); ++i) {
    const double u = PatchExtent::kCellSize * (static_cast<double>(i) + 0.5);
    places.push_back(
        {{static_cast<int>(i), 0}, values_m[i], kNoiseVariance, Eigen::Vector3d(1.0, u, 0.0)});
  }
  return places;
}

std::vector<int> LevelsOf(const SurfacePlaces& places) {
  return FindLevels(places, kUnevenness).of_place;
}

int NumOff(const SurfacePlaces& places) {
  const std::vector<int> levels = LevelsOf(places);
  return static_cast<int>(levels.size()) -
         static_cast<int>(std::count(levels.begin(), levels.end(), kOnSurface));
}

TEST(FindLevelsTest, AnUnevenWallIsOnePlane) {
  std::mt19937 random(5);
  std::normal_distribution<double> unevenness(0.0, kUnevenness);
  int num_off = 0;
  for (int wall = 0; wall < 100; ++wall) {
    std::vector<double> values_m(16);
    for (double& value_m : values_m) value_m = unevenness(random);
    num_off += NumOff(Wall(values_m));
  }
  EXPECT_LT(num_off, 16) << "a hundredth of 1600";
}

TEST(FindLevelsTest, AWallThatIsEstimatedWrongIsOnePlane) {
  std::vector<double> values_m;
  for (int i = 0; i < 16; ++i) values_m.push_back(0.05 - 0.01 * i);
  EXPECT_EQ(NumOff(Wall(values_m)), 0);
}

TEST(FindLevelsTest, ARecessThatTurnsTheWallIsALevel) {
  std::vector<double> values_m(16, 0.0);
  for (const size_t at : {13, 14, 15}) values_m[at] = 0.03;
  // The estimate has given way to it by half.
  for (size_t i = 0; i < 16; ++i) values_m[i] -= 0.01 / 8.0 * (static_cast<double>(i) - 7.5);
  const std::vector<int> levels = LevelsOf(Wall(values_m));
  for (size_t i = 0; i < 16; ++i) EXPECT_EQ(levels[i] > kOnSurface, i >= 13) << i;
}

TEST(FindLevelsTest, OfTwoLevelsThatATiltedPlaneFitsTheLighterLeaves) {
  std::vector<double> values_m(16, -0.01);
  for (size_t at = 10; at < 16; ++at) values_m[at] = 0.01;
  for (size_t i = 0; i < 16; ++i) values_m[i] -= 0.0018 * (static_cast<double>(i) - 7.5);
  const SurfaceLevels found = FindLevels(Wall(values_m), kUnevenness);
  for (size_t i = 0; i < 16; ++i) {
    ASSERT_EQ(found.of_place[i] > kOnSurface, i >= 10) << i;
  }
  const auto level = static_cast<size_t>(found.of_place[15]) - 1;
  EXPECT_NEAR(found.steps_m[level], 0.02, 1e-9);
}

TEST(FindLevelsTest, WhatLiesBeforeAndBehindAStripAreTwoLevels) {
  std::vector<double> values_m(16, 0.0);
  for (size_t i = 0; i < 16; ++i) values_m[i] = i < 4 || i > 12 ? 0.03 : 0.0;
  const std::vector<int> levels = LevelsOf(Wall(values_m));
  EXPECT_GT(levels[0], kOnSurface);
  EXPECT_GT(levels[15], kOnSurface);
  EXPECT_NE(levels[0], levels[15]);
}

TEST(FindLevelsTest, RowsAreLevelsToo) {
  SurfacePlaces places;
  for (int u = 0; u < 6; ++u) {
    for (int v = 0; v < 8; ++v) {
      places.push_back({{u, v}, v < 3 ? 0.02 : 0.0, kNoiseVariance, {1.0, 0.25 * u, 0.0}});
    }
  }
  const std::vector<int> levels = LevelsOf(places);
  for (size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(levels[i] > kOnSurface, places[i].cell.second < 3);
  }
}

TEST(FindLevelsTest, APlaceAmongOthersIsOffAlone) {
  SurfacePlaces places;
  for (int u = 0; u < 6; ++u) {
    for (int v = 0; v < 8; ++v) {
      const double value_m = u == 3 && v == 4 ? 0.03 : 0.0;
      places.push_back({{u, v}, value_m, kNoiseVariance, {1.0, 0.25 * u, 0.0}});
    }
  }
  EXPECT_EQ(NumOff(places), 1);
  EXPECT_EQ(LevelsOf(places)[3 * 8 + 4], kOffAlone);
}

TEST(FindLevelsTest, APlaceThatAloneShowsTheHeadingIsNotTested) {
  SurfacePlaces places = Wall(std::vector<double>(5, 0.0));
  for (PlaceDeviation& place : places) place.by_surface = {1.0, 0.0, 0.0};
  places[3].by_surface.y() = 2.0;
  places[3].value_m = 0.5;
  EXPECT_EQ(NumOff(places), 0);
}

TEST(EstimateUnevennessTest, FewPlacesOnOtherSurfacesDoNotCount) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, 1.0);
  const auto estimate = [&](double unevenness_m, double noise_m, int every) {
    std::vector<SurfacePlaces> surfaces;
    for (int wall = 0; wall < 100; ++wall) {
      std::vector<double> values_m(16);
      for (double& value_m : values_m) {
        value_m = unevenness_m * normal(random) + noise_m * normal(random);
      }
      if (wall % every == 0) values_m[9] += 0.05;
      surfaces.push_back(Wall(values_m));
      for (PlaceDeviation& place : surfaces.back()) place.variance = noise_m * noise_m;
    }
    return EstimateUnevenness(surfaces);
  };
  EXPECT_NEAR(estimate(0.004, 0.002, 200), 0.004, 0.0004);
  EXPECT_NEAR(estimate(0.004, 0.002, 4), 0.004, 0.0006);
  EXPECT_LT(estimate(0.0, 0.002, 200), 0.001);
  EXPECT_EQ(EstimateUnevenness({}), 0.0);
}

// A wall along x at y = 2; u runs along it, v upwards.
class PlaceDeviationsTest : public ::testing::Test {
 protected:
  PlaceDeviationsTest() : wall_(MakeVerticalLandmark({0.0, -1.0, 0.0}, {0.0, 2.0, 0.0})) {
    wall_.extent.AddSegment({-3.0, 2.0, 0.0}, {3.0, 2.0, 0.0});
  }

  Landmark wall_;
};

TEST_F(PlaceDeviationsTest, TheCellBeforeWhichSomethingStandsIsOff) {
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0.0, 0.03);
  std::uniform_real_distribution<double> along(-3.0, 3.0);
  const Eigen::Vector2d before(1.3, 0.1);
  PlaceDeviations all;
  PlaceDeviations first;
  PlaceDeviations second;
  for (int i = 0; i < 40000; ++i) {
    const Eigen::Vector2d uv(along(random), 0.1);
    const bool is_before = PatchExtent::CellAt(uv) == PatchExtent::CellAt(before);
    const double deviation_m = (is_before ? 0.03 : 0.0) + noise(random);
    all.Add(uv, deviation_m, 0.03);
    (i % 2 == 0 ? first : second).Add(uv, deviation_m, 0.03);
  }
  const auto cells_off = [&](const PlaceDeviations& deviations, double unevenness_m) {
    const SurfacePlaces places = deviations.PlacesOn(wall_);
    const std::vector<int> levels = FindLevels(places, unevenness_m).of_place;
    std::vector<PatchExtent::Cell> cells;
    for (size_t i = 0; i < places.size(); ++i) {
      if (levels[i] != kOnSurface) cells.push_back(places[i].cell);
    }
    return cells;
  };
  const std::vector<PatchExtent::Cell> off = {PatchExtent::CellAt(before)};
  EXPECT_EQ(cells_off(all, kUnevenness), off);
  EXPECT_TRUE(cells_off(all, 0.03).empty()) << "as uneven as that";
  second.Add(first);
  EXPECT_EQ(cells_off(second, kUnevenness), off);
}

TEST_F(PlaceDeviationsTest, NoiseOfMoreThanAMetreTellsNothing) {
  PlaceDeviations deviations;
  deviations.Add({1.0, 0.1}, 0.5, 2.0);
  EXPECT_TRUE(deviations.PlacesOn(wall_).empty());
}

}  // namespace
}  // namespace plumbline
