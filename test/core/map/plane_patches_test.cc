#include "core/map/plane_patches.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/map/map_state.h"

namespace plumbline {
namespace {

// A cylinder whose surface has moved off its anchor, with standard deviations of its
// parameters.
MapState StateWithCylinder(double curvature) {
  MapState state{Trajectory(0, 125'000'000, Rigid3d()), {}, {}, 0, {}};
  Landmark cylinder = MakeCylinderLandmark({0.6, 0.8, 0.0}, curvature, {3.0, 1.0, 0.2});
  cylinder.extent.AddSegment({3.0, 1.0, 0.2}, {3.8, 0.4, 1.2});
  cylinder.parameters[2] = 0.05;
  cylinder.covariance.diagonal() << 1e-6, 4e-6, 9e-6;
  cylinder.num_segments = 1;
  state.landmarks.push_back(cylinder);
  return state;
}

// The stated deviations are those that the parameters' make of what is stated.
TEST(PlanePatchesTest, RadiusHasTheDeviationOfCurvatureAndDistance) {
  for (const double curvature : {-0.4, 0.4, -1.0 / 13.2}) {
    MapState state = StateWithCylinder(curvature);
    const PlanePatch stated = PlanePatches(state).front();
    double variance = 0.0;
    for (size_t parameter = 0; parameter < 3; ++parameter) {
      constexpr double kStep = 1e-6;
      const auto radius_at = [&](double step) {
        MapState moved = state;
        moved.landmarks.front().parameters[parameter] += step;
        return PlanePatches(moved).front().Radius();
      };
      const double derivative = (radius_at(kStep) - radius_at(-kStep)) / (2.0 * kStep);
      const auto at = static_cast<Eigen::Index>(parameter);
      variance += derivative * derivative * state.landmarks.front().covariance(at, at);
    }
    EXPECT_NEAR(stated.sigma_radius_m, std::sqrt(variance), 1e-4 * stated.sigma_radius_m);
  }
}

// Where the whole map shifts, a column keeps its radius.
TEST(PlanePatchesTest, AShiftLeavesTheRadiusKnown) {
  MapState state = StateWithCylinder(0.5);
  Landmark& column = state.landmarks.front();
  column.parameters[2] = 0.0;
  // The axis, half a curvature's inverse behind the anchor, moves along the normal by 1 cm.
  constexpr double kShift = 0.01;
  const double k = column.Curvature();
  const Eigen::Vector3d by_shift(0.0, k * k, 1.0);  // of radius 1 / k, to first order
  column.covariance = kShift * kShift * by_shift * by_shift.transpose();
  const PlanePatch stated = PlanePatches(state).front();
  EXPECT_NEAR(stated.sigma_distance_m, kShift, 0.2 * kShift);
  EXPECT_LT(stated.sigma_radius_m, 1e-6);
}

}  // namespace
}  // namespace plumbline
