#include "core/visibility/place_deviations.h"

#include <gtest/gtest.h>

#include <random>

namespace plumbline {
namespace {

constexpr double kFlatness = 0.004;

// Places along a wall of 4 m, a quarter of a metre each: the wall's parameters are its distance
// and its heading.
std::vector<PlaceDeviation> Wall(const std::vector<double>& values_m) {
  std::vector<PlaceDeviation> places;
  for (size_t i = 0; i < values_m.size(); ++i) {
    const double u = 0.25 * (static_cast<double>(i) + 0.5);
    places.push_back({values_m[i], kFlatness * kFlatness, {1.0, u, 0.0}});
  }
  return places;
}

TEST(FindPlacesOffTest, AnUnevenWallIsOnePlane) {
  std::mt19937 random(5);
  std::normal_distribution<double> unevenness(0.0, kFlatness);
  int num_off = 0;
  for (int wall = 0; wall < 100; ++wall) {
    std::vector<double> values_m(16);
    for (double& value_m : values_m) value_m = unevenness(random);
    for (const bool is_off : FindPlacesOff(Wall(values_m))) num_off += is_off ? 1 : 0;
  }
  EXPECT_LT(num_off, 16) << "a hundredth of 1600";
}

TEST(FindPlacesOffTest, AWallThatIsEstimatedWrongIsOnePlane) {
  std::vector<double> values_m;
  for (int i = 0; i < 16; ++i) values_m.push_back(0.05 - 0.01 * i);
  for (const bool is_off : FindPlacesOff(Wall(values_m))) EXPECT_FALSE(is_off);
}

TEST(FindPlacesOffTest, ARecessThatTurnsTheWallIsFoundOnItsOwn) {
  std::vector<double> values_m(16, 0.0);
  for (const size_t at : {13, 14, 15}) values_m[at] = 0.03;
  // The estimate has given way to it by half.
  for (size_t i = 0; i < 16; ++i) values_m[i] -= 0.01 / 8.0 * (static_cast<double>(i) - 7.5);
  const std::vector<bool> is_off = FindPlacesOff(Wall(values_m));
  for (size_t i = 0; i < 16; ++i) EXPECT_EQ(is_off[i], i >= 13) << i;
}

TEST(FindPlacesOffTest, APlaceThatAloneShowsTheHeadingIsNotTested) {
  std::vector<PlaceDeviation> places(5, {0.0, kFlatness * kFlatness, {1.0, 0.0, 0.0}});
  places[3] = {0.5, kFlatness * kFlatness, {1.0, 2.0, 0.0}};
  for (const bool is_off : FindPlacesOff(places)) EXPECT_FALSE(is_off);
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
  const std::vector<PatchExtent::Cell> off = {PatchExtent::CellAt(before)};
  EXPECT_EQ(all.CellsOff(wall_, kFlatness), off);
  EXPECT_TRUE(all.CellsOff(wall_, 0.03).empty()) << "as uneven as that";
  second.Add(first);
  EXPECT_EQ(second.CellsOff(wall_, kFlatness), off);
}

}  // namespace
}  // namespace plumbline
