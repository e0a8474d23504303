#include "core/plane_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace plumbline {
namespace {

TEST(PlaneSet, FindsThoseWithinADistanceInOrder) {
  std::mt19937_64 random(5);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (const size_t count : {0u, 1u, 4u, 11u}) {  // blocks that are full and some that are not
    std::vector<Landmark> landmarks;
    for (size_t i = 0; i < count; ++i) {
      const Eigen::Vector3d p(uniform(-3.0, 3.0), uniform(-3.0, 3.0), uniform(0.0, 3.0));
      const double angle = uniform(-M_PI, M_PI);
      landmarks.push_back(
          i % 3 == 0 ? MakeHorizontalLandmark(1.0, p)
                     : MakeVerticalLandmark({std::cos(angle), std::sin(angle), 0.0}, p));
    }
    std::vector<LandmarkCandidate> planes;
    for (const Landmark& landmark : landmarks) planes.emplace_back(landmark);
    const PlaneSet set(planes);
    EXPECT_EQ(set.planes().size(), count);
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d p(uniform(-4.0, 4.0), uniform(-4.0, 4.0), uniform(-1.0, 4.0));
      std::vector<const Landmark*> expected;
      for (const LandmarkCandidate& plane : planes) {
        if (std::abs(plane.SignedDistance(p)) <= 1.0) expected.push_back(plane.landmark);
      }
      std::vector<const Landmark*> found;
      set.ForEachWithin(
          p, 1.0, [&](const LandmarkCandidate& plane) { found.push_back(plane.landmark); });
      EXPECT_EQ(found, expected);
    }
  }
}

}  // namespace
}  // namespace plumbline
