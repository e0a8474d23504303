#include "core/outputs/floor_map.h"

#include <gtest/gtest.h>

#include <vector>

namespace plumbline {
namespace {

FloorArea LevelAt(double height_m) {
  FloorArea area;
  area.floor.distance = height_m;
  return area;
}

// Sightings of an area, every 5 cm in a rectangle.
void See(size_t area,
         const Eigen::Vector2d& low,
         const Eigen::Vector2d& high,
         std::vector<FloorMap::Sighting>* sightings) {
  for (double x = low.x(); x <= high.x(); x += 0.05) {
    for (double y = low.y(); y <= high.y(); y += 0.05) sightings->push_back({{x, y}, area});
  }
}

double HeightAt(const FloorMap& map, const Eigen::Vector2d& p) {
  return map.At(p).floor.HeightAt(p);
}

TEST(LevelOrSlopeTest, HeightIsThatOfThePlane) {
  LevelOrSlope slope;
  slope.normal = Eigen::Vector3d(-0.6, 0.0, 0.8);
  slope.distance = 0.8;
  EXPECT_NEAR(slope.HeightAt({0.0, 5.0}), 1.0, 1e-12);
  EXPECT_NEAR(slope.HeightAt({4.0, 5.0}), 4.0, 1e-12);
  // Of a ceiling, which is seen from below, the normal points down.
  slope.normal *= -1.0;
  slope.distance *= -1.0;
  EXPECT_NEAR(slope.HeightAt({4.0, 5.0}), 4.0, 1e-12);
}

TEST(FloorMapTest, PlacesLieOnTheFloorThatWasSeenThere) {
  std::vector<FloorMap::Sighting> sightings;
  See(0, {0.0, 0.0}, {2.0, 3.0}, &sightings);
  See(1, {2.2, 0.0}, {4.0, 3.0}, &sightings);
  const FloorMap map({LevelAt(0.0), LevelAt(0.3)}, sightings);
  EXPECT_EQ(HeightAt(map, {1.0, 1.0}), 0.0);
  EXPECT_EQ(HeightAt(map, {3.0, 2.0}), 0.3);
  EXPECT_EQ(map.lowest_m(), 0.0);
  EXPECT_EQ(map.highest_m(), 0.3);
}

TEST(FloorMapTest, ElsewhereTheNearestOneCounts) {
  std::vector<FloorMap::Sighting> sightings;
  See(0, {0.0, 0.0}, {1.0, 1.0}, &sightings);
  See(1, {5.0, 0.0}, {6.0, 1.0}, &sightings);
  const FloorMap map({LevelAt(0.0), LevelAt(0.3)}, sightings);
  EXPECT_EQ(HeightAt(map, {2.5, 0.5}), 0.0);
  EXPECT_EQ(HeightAt(map, {3.5, 0.5}), 0.3);
  // Beyond everything that was seen.
  EXPECT_EQ(HeightAt(map, {-100.0, 50.0}), 0.0);
  EXPECT_EQ(HeightAt(map, {100.0, -50.0}), 0.3);
}

// A stair's step is seen through the floor's strays.
TEST(FloorMapTest, OfSeveralInOneSquareTheOneThatWasSeenMostCounts) {
  std::vector<FloorMap::Sighting> sightings;
  See(0, {0.0, 0.0}, {2.0, 2.0}, &sightings);
  sightings.push_back({{1.02, 1.02}, 1});
  const FloorMap map({LevelAt(0.0), LevelAt(0.3)}, sightings);
  EXPECT_EQ(HeightAt(map, {1.02, 1.02}), 0.0);
  for (int i = 0; i < 20; ++i) sightings.push_back({{1.02, 1.02}, 1});
  EXPECT_EQ(HeightAt(FloorMap({LevelAt(0.0), LevelAt(0.3)}, sightings), {1.02, 1.02}), 0.3);
}

TEST(FloorMapTest, RampHasItsHeightsWhereItWasSeen) {
  FloorArea ramp;
  ramp.floor.normal = Eigen::Vector3d(-0.1, 0.0, 1.0);
  const FloorMap map({ramp}, {{{1.0, 0.0}, 0}, {{6.0, 2.0}, 0}});
  EXPECT_NEAR(map.lowest_m(), 0.1, 1e-12);
  EXPECT_NEAR(map.highest_m(), 0.6, 1e-12);
  EXPECT_NEAR(HeightAt(map, {3.0, 1.0}), 0.3, 1e-12);
}

TEST(FloorMapTest, OneSightingIsEnoughAndAStrayFarAwayCostsNoMemory) {
  const FloorMap one({LevelAt(0.7)}, {{{3.0, 4.0}, 0}});
  EXPECT_EQ(HeightAt(one, {0.0, 0.0}), 0.7);
  std::vector<FloorMap::Sighting> sightings;
  See(0, {0.0, 0.0}, {1.0, 1.0}, &sightings);
  sightings.push_back({{1e6, 0.0}, 1});
  const FloorMap map({LevelAt(0.0), LevelAt(0.3)}, sightings);
  EXPECT_EQ(HeightAt(map, {0.5, 0.5}), 0.0);
  EXPECT_EQ(HeightAt(map, {9e5, 0.0}), 0.3);
}

}  // namespace
}  // namespace plumbline
