#include "core/visibility/plane_set.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <deque>
#include <random>
#include <utility>
#include <vector>

#include "core/surface/landmark_view.h"
#include "core/visibility/plane_trace.h"

namespace plumbline {
namespace {

// Its parameter: how many planes, so that there are blocks that are full and some that are
// not.
class PlaneSetTest : public ::testing::TestWithParam<size_t> {
 protected:
  PlaneSetTest() {
    for (size_t i = 0; i < GetParam(); ++i) {
      const Eigen::Vector3d p = Point(3.0);
      const double angle = Uniform(-M_PI, M_PI);
      landmarks_.push_back(
          i % 3 == 0 ? MakeHorizontalLandmark(1.0, p)
                     : MakeVerticalLandmark({std::cos(angle), std::sin(angle), 0.0}, p));
      planes_.emplace_back(landmarks_.back());
    }
  }

  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Eigen::Vector3d Point(double size) {
    return {Uniform(-size, size), Uniform(-size, size), Uniform(-size, size)};
  }

  std::mt19937_64 random_{5};
  std::deque<Landmark> landmarks_;
  std::vector<LandmarkView> planes_;
};

TEST_P(PlaneSetTest, FindsThoseWithinADistanceInOrder) {
  const PlaneSet set(planes_);
  EXPECT_EQ(set.planes().size(), GetParam());
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p = Point(4.0);
    std::vector<const Landmark*> expected;
    for (const LandmarkView& plane : planes_) {
      if (std::abs(plane.SignedDistance(p)) <= 1.0) expected.push_back(plane.landmark);
    }
    std::vector<const Landmark*> found;
    set.ForEachWithin(
        p, 1.0, [&](const LandmarkView& plane) { found.push_back(plane.landmark); });
    EXPECT_EQ(found, expected);
  }
}

TEST_P(PlaneSetTest, FindsThoseThatABeamMeetsBetweenTwoRangesInOrder) {
  constexpr double kMax = 3.0;
  const PlaneSet set(planes_);
  for (int i = 0; i < 100; ++i) {
    const double min = i % 2 == 0 ? 1.0 : -0.2;  // below zero: of a beam of a few decimetres
    const ScanPlacement placement = PlacementOf(
        {Eigen::Quaterniond(
             Uniform(-1.0, 1.0), Uniform(-1.0, 1.0), Uniform(-1.0, 1.0), Uniform(-1.0, 1.0))
             .normalized(),
         Point(4.0)});
    const double angle = Uniform(-M_PI, M_PI);
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    std::vector<std::pair<const Landmark*, double>> expected;
    for (const LandmarkView& plane : planes_) {
      if (plane.SignedDistance(placement.col(2)) <= 0.0) continue;  // seen from behind
      const double range = Trace(placement, plane).RangeAlong(direction);
      if (range > min && range < kMax) expected.emplace_back(plane.landmark, range);
    }
    std::vector<std::pair<const Landmark*, double>> found;
    PlaneRanges(set, placement)
        .ForEachBetween(direction, min, kMax, [&](const LandmarkView& plane, double range) {
          found.emplace_back(plane.landmark, range);
        });
    ASSERT_EQ(found.size(), expected.size());
    for (size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].first, expected[k].first);
      EXPECT_NEAR(found[k].second, expected[k].second, 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Counts, PlaneSetTest, ::testing::Values(0, 1, 4, 11));

}  // namespace
}  // namespace plumbline
