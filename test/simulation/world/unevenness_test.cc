#include "simulation/world/unevenness.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

// A hundred faces x = 0 that are seen from x > 0.
Building Walls() {
  Building building;
  for (int i = 0; i < 100; ++i) {
    Face& face = building.faces.emplace_back();
    face.id = i;
    face.normal = Eigen::Vector3d::UnitX();
  }
  return building;
}

TEST(Unevenness, HasTheStandardDeviationAndCorrelation) {
  const Unevenness unevenness({0.004, 0.5}, Walls(), 1);
  double square = 0.0;
  double product = 0.0;
  constexpr int kSpots = 100;
  for (int face = 0; face < 100; ++face) {
    for (int i = 0; i < kSpots; ++i) {
      const Eigen::Vector3d p(0, 3.0 * i, 1.0);
      const Eigen::Vector3d near = p + Eigen::Vector3d(0, 0.5, 0);
      const double a = unevenness.RangeError(face, p, -Eigen::Vector3d::UnitX());
      square += a * a;
      product += a * unevenness.RangeError(face, near, -Eigen::Vector3d::UnitX());
    }
  }
  const double variance = square / (100 * kSpots);
  // 10,000 independent spots: four standard deviations of a variance are 6 %, the spread of
  // the faces' finitely many waves less.
  EXPECT_NEAR(variance, 0.004 * 0.004, 0.06 * 0.004 * 0.004);
  EXPECT_NEAR(product / square, std::exp(-0.5), 0.06);
}

TEST(Unevenness, IsTheSameWheneverASpotIsSeen) {
  const Building walls = Walls();
  const Unevenness unevenness({0.004, 0.5}, walls, 7);
  const Eigen::Vector3d p(0, 1, 2);
  const double straight = unevenness.RangeError(3, p, -Eigen::Vector3d::UnitX());
  EXPECT_EQ(straight,
            Unevenness({0.004, 0.5}, walls, 7).RangeError(3, p, -Eigen::Vector3d::UnitX()));
  EXPECT_NE(straight, unevenness.RangeError(4, p, -Eigen::Vector3d::UnitX()));
  // A beam at 60 degrees to the normal meets the bump twice as early.
  const Eigen::Vector3d slanting(-0.5, std::sqrt(0.75), 0);
  EXPECT_NEAR(unevenness.RangeError(3, p, slanting), 2 * straight, 1e-12);
}

TEST(Unevenness, EvenWallsAndMovingThingsHaveNone) {
  const Building walls = Walls();
  EXPECT_EQ(Unevenness({0.0, 0.5}, walls, 1).RangeError(3, {0, 1, 2}, {-1, 0, 0}), 0.0);
  EXPECT_EQ(Unevenness({0.004, 0.5}, walls, 1).RangeError(-1, {0, 1, 2}, {-1, 0, 0}), 0.0);
}

}  // namespace
}  // namespace plumbline
