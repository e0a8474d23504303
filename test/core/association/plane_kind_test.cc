#include "core/association/plane_kind.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

const Eigen::Vector3d kAbove(1.0, 2.0, 3.0);

// A fit through (1, 2, 0) whose normal leans towards x from the vertical, known alike in both
// directions; angles in degrees.
PlaneThroughLines::Fit FitAt(double from_vertical_deg, double sigma_deg) {
  const double angle = from_vertical_deg * kRadiansPerDegree;
  const double sigma = sigma_deg * kRadiansPerDegree;
  PlaneThroughLines::Fit fit;
  fit.centre_world = {1.0, 2.0, 0.0};
  fit.normal = {std::sin(angle), 0.0, std::cos(angle)};
  fit.normal_covariance =
      sigma * sigma * (Eigen::Matrix3d::Identity() - fit.normal * fit.normal.transpose());
  fit.centre_variance = 1e-4;
  fit.chi2 = 1.0;
  return fit;
}

TEST(DecideKind, TakesForLevelAndUprightWhatDoesNotContradictIt) {
  const auto floor = DecideKind(FitAt(0.2, 0.1), kAbove);
  ASSERT_TRUE(floor);
  EXPECT_EQ(floor->model, PlaneModel::kHorizontal);
  EXPECT_DOUBLE_EQ(floor->Normal().z(), 1.0);
  const auto wall = DecideKind(FitAt(89.5, 0.1), {0.0, 2.0, 0.0});
  ASSERT_TRUE(wall);
  EXPECT_EQ(wall->model, PlaneModel::kVertical);
  EXPECT_DOUBLE_EQ(wall->Normal().x(), -1.0);
}

TEST(DecideKind, KnowsASlopeThatIsMeasuredWell) {
  const auto ramp = DecideKind(FitAt(1.4, 0.05), kAbove);
  ASSERT_TRUE(ramp);
  EXPECT_EQ(ramp->model, PlaneModel::kGeneral);
  EXPECT_NEAR(ramp->SignedDistance({1.0, 2.0, 0.0}), 0.0, 1e-12);
  EXPECT_NEAR(ramp->Normal().z(), std::cos(1.4 * kRadiansPerDegree), 1e-12);
}

TEST(DecideKind, FacesTheSideThatItWasSeenFrom) {
  for (const double tilt_deg : {0.1, 40.0}) {
    EXPECT_GT(DecideKind(FitAt(tilt_deg, 0.05), kAbove)->Normal().z(), 0.0);
    EXPECT_LT(DecideKind(FitAt(tilt_deg, 0.05), {1.0, 2.0, -3.0})->Normal().z(), 0.0);
  }
}

TEST(DecideKind, LeavesOpenWhatIsHardlyKnown) {
  EXPECT_FALSE(DecideKind(FitAt(0.2, 2.0), kAbove));   // a floor, or a ramp
  EXPECT_FALSE(DecideKind(FitAt(1.5, 0.6), kAbove));   // looks level for want of precision
  EXPECT_TRUE(DecideKind(FitAt(89.5, 2.0), kAbove));   // walls are likelier than other planes
  EXPECT_FALSE(DecideKind(FitAt(89.5, 2.5), kAbove));  // but not in any direction
}

TEST(DecideKind, StatesAWallsCovarianceAtItsCentre) {
  const auto fit = FitAt(90.0, 0.1);
  const auto wall = DecideKind(fit, {5.0, 2.0, 0.0});
  ASSERT_TRUE(wall);
  const Eigen::RowVector3d by_parameters =
      wall->DeviationJacobian(fit.centre_world, Eigen::Vector3d::UnitY()).row(0);
  EXPECT_NEAR(by_parameters.dot(by_parameters * wall->covariance), fit.centre_variance, 1e-9);
}

}  // namespace
}  // namespace plumbline
