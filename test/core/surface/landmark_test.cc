#include "core/surface/landmark.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

TEST(LandmarkTest, PassesThroughItsPoint) {
  const Eigen::Vector3d p(1.0, -2.0, 0.7);
  const Landmark floor = MakeHorizontalLandmark(1.0, p);
  const Landmark ceiling = MakeHorizontalLandmark(-1.0, p);
  const Landmark wall = MakeVerticalLandmark({0.3, -0.4, 0.0}, p);
  EXPECT_EQ(floor.Normal(), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(ceiling.Normal(), -Eigen::Vector3d::UnitZ());
  EXPECT_LT((wall.Normal() - Eigen::Vector3d(0.6, -0.8, 0.0)).norm(), 1e-12);
  for (const Landmark& landmark : {floor, ceiling, wall}) {
    EXPECT_NEAR(landmark.SignedDistance(p), 0.0, 1e-12);
    EXPECT_NEAR(landmark.SignedDistance(p + 2.0 * landmark.Normal()), 2.0, 1e-12);
    // The extent's axes lie on the plane.
    EXPECT_NEAR(landmark.extent.axes().u.dot(landmark.Normal()), 0.0, 1e-12);
    EXPECT_NEAR(landmark.extent.axes().v.dot(landmark.Normal()), 0.0, 1e-12);
  }
}

TEST(LandmarkTest, SegmentsContradictAPlaneTogether) {
  const auto agrees = [](int count, double squared_deviation) {
    Landmark landmark;
    for (int i = 0; i < count; ++i) landmark.Judge(squared_deviation);
    return landmark.AgreesWithin(4.0);
  };
  EXPECT_TRUE(agrees(0, 0.0));
  EXPECT_TRUE(agrees(1, 5.5));
  EXPECT_FALSE(agrees(1, 6.5));
  EXPECT_TRUE(agrees(100, 4.0));
  EXPECT_FALSE(agrees(100, 4.1));
}

TEST(LandmarkTest, DeviationJacobianAgreesWithFiniteDifferences) {
  const Eigen::Vector3d p(3.0, -1.0, 0.5);
  const Eigen::Vector3d direction = Eigen::Vector3d(0.4, 0.7, -0.5).normalized();
  constexpr double kStep = 1e-6;
  Landmark roof = MakeGeneralLandmark({-0.48, 0.36, -0.8}, {1.0, 2.0, 3.3});
  roof.parameters = {0.2, -0.1, 0.4};
  for (const Landmark& landmark : {MakeHorizontalLandmark(1.0, {1.0, 2.0, 0.3}),
                                   MakeHorizontalLandmark(-1.0, {1.0, 2.0, 2.3}),
                                   MakeVerticalLandmark({-0.8, 0.6, 0.0}, {1.0, 2.0, 0.3}),
                                   roof}) {
    const Eigen::Matrix<double, 2, 3> jacobian = landmark.DeviationJacobian(p, direction);
    for (int i = 0; i < 3; ++i) {
      Eigen::Vector2d expected = Eigen::Vector2d::Zero();
      if (i < landmark.num_parameters()) {
        Landmark plus = landmark, minus = landmark;
        plus.parameters[static_cast<size_t>(i)] += kStep;
        minus.parameters[static_cast<size_t>(i)] -= kStep;
        expected << plus.SignedDistance(p) - minus.SignedDistance(p),
            (plus.Normal() - minus.Normal()).dot(direction);
        expected /= 2.0 * kStep;
      }
      EXPECT_LT((jacobian.col(i) - expected).norm(), 1e-8);
    }
  }
}

// Near each of its points a cylinder is its tangent plane, and its derivatives are those of
// its signed distance.
TEST(LandmarkTest, ACylinderIsAPlaneNearAPoint) {
  Landmark cylinder = MakeCylinderLandmark({0.6, 0.8, 0.0}, -0.25, {3.0, -1.0, 1.0});
  cylinder.parameters[2] = 0.01;
  const double gradient = std::sqrt(1.0 - 2.0 * 0.25 * 0.01);
  const Eigen::Vector2d axis(3.0 + 4.0 * 0.6, -1.0 + 4.0 * 0.8);
  for (const double angle : {0.3, 2.0, 4.5}) {
    const Eigen::Vector2d outwards(std::cos(angle), std::sin(angle));
    Eigen::Vector3d p;
    p << axis + 4.0 * gradient * outwards, 7.0;
    EXPECT_NEAR(cylinder.SignedDistance(p), 0.0, 1e-12);
    EXPECT_NEAR(cylinder.NormalNear(p).head<2>().dot(outwards), -gradient, 1e-12);
    p.head<2>() -= 0.2 * outwards;
    const Eigen::Vector3d direction(0.0, 1.0, 0.0);
    const Eigen::Matrix<double, 2, 3> jacobian = cylinder.DeviationJacobian(p, direction);
    for (size_t i = 0; i < 3; ++i) {
      constexpr double kStep = 1e-6;
      Landmark moved = cylinder;
      moved.parameters[i] += kStep;
      const auto column = static_cast<Eigen::Index>(i);
      EXPECT_NEAR(jacobian(0, column),
                  (moved.SignedDistance(p) - cylinder.SignedDistance(p)) / kStep,
                  1e-5);
      EXPECT_NEAR(jacobian(1, column),
                  (moved.NormalNear(p) - cylinder.NormalNear(p)).dot(direction) / kStep,
                  1e-5);
    }
  }
}

}  // namespace
}  // namespace plumbline
