#include "core/surface/landmark.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

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

// One landmark of each kind, off the values that it was founded with.
std::vector<Landmark> OneOfEach() {
  std::vector<Landmark> landmarks = {
      MakeHorizontalLandmark(1.0, {1.0, 2.0, 0.3}),
      MakeHorizontalLandmark(-1.0, {1.0, 2.0, 2.3}),
      MakeVerticalLandmark({-0.8, 0.6, 0.0}, {1.0, 2.0, 0.3}),
      MakeGeneralLandmark({-0.48, 0.36, -0.8}, {1.0, 2.0, 3.3}),
      MakeCylinderLandmark({0.6, 0.8, 0.0}, -0.25, {3.0, -1.0, 1.0})};
  for (Landmark& landmark : landmarks) {
    for (size_t i = 0; i < 3; ++i)
      landmark.parameters[i] += 0.02 + 0.01 * static_cast<double>(i);
    Eigen::Matrix3d root;
    root << 0.02, 0.0, 0.0, 0.01, 0.03, 0.0, -0.02, 0.01, 0.01;
    const int size = landmark.num_parameters();
    landmark.covariance.topLeftCorner(size, size) =
        (root * root.transpose()).topLeftCorner(size, size);
  }
  return landmarks;
}

// Traits that need an upright surface: a floor ends at one, and what bends is one. A trace on
// any other may look like its own.
TEST(LandmarkTest, UprightSurfacesHaveLevelNormals) {
  const Eigen::Vector3d p(2.0, 1.0, -3.0);
  for (const Landmark& landmark : OneOfEach()) {
    const bool is_upright = landmark.NormalNear(p).z() == 0.0;
    EXPECT_EQ(TraitsOf(landmark).bounds_floors, is_upright);
    EXPECT_EQ(TraitsOf(landmark).may_bend, is_upright);
    EXPECT_EQ(TraitsOf(landmark).passes_for_wall, !is_upright);
    EXPECT_EQ(landmark.IsCurved(), landmark.Curvature() != 0.0);
  }
}

// Height does not count: one sees of a wall what the scanners reach.
TEST(LandmarkTest, IsAsWideAsItReachesAlongTheFloor) {
  for (Landmark& landmark : OneOfEach()) {
    const PatchExtent& extent = landmark.extent;
    landmark.extent.AddSegment(extent.ToWorld({0.0, 0.0}), extent.ToWorld({3.0, 0.5}));
    const bool is_level = landmark.NormalNear(extent.axes().anchor).head<2>().isZero();
    EXPECT_NEAR(landmark.Width(), is_level ? 0.5 : 3.0, 0.02);
  }
}

// A wall alone has a heading to hold and doors, a floor goes on behind walls, and planes in
// between have no clear edge.
TEST(LandmarkTest, EachKindHasItsTraits) {
  const Eigen::Vector3d p(1.0, -2.0, 0.7);
  const Eigen::Vector3d across = Eigen::Vector3d::UnitX();
  const SurfaceTraits floor = TraitsOf(MakeHorizontalLandmark(1.0, p));
  const SurfaceTraits wall = TraitsOf(MakeVerticalLandmark(across, p));
  const SurfaceTraits slope = TraitsOf(MakeGeneralLandmark({0.6, 0.0, 0.8}, p));
  const SurfaceTraits arc = TraitsOf(MakeCylinderLandmark(across, 0.2, p));
  EXPECT_TRUE(floor.goes_on_behind_walls);
  EXPECT_TRUE(wall.has_heading && wall.has_doorways);
  EXPECT_FALSE(floor.has_heading || slope.has_heading || arc.has_heading);
  EXPECT_FALSE(floor.has_doorways || slope.has_doorways || arc.has_doorways);
  EXPECT_FALSE(wall.goes_on_behind_walls || slope.goes_on_behind_walls ||
               arc.goes_on_behind_walls);
  EXPECT_TRUE(slope.has_soft_edges && arc.has_soft_edges);
  EXPECT_FALSE(floor.has_soft_edges || wall.has_soft_edges);
}

TEST(LandmarkTest, TangentsLieOnTheSurface) {
  for (const Landmark& landmark : OneOfEach()) {
    const Eigen::Vector3d normal = landmark.Normal().normalized();
    const Eigen::Matrix<double, 3, 2> tangents = landmark.Tangents(normal);
    EXPECT_LT((tangents.transpose() * tangents - Eigen::Matrix2d::Identity()).norm(), 1e-12);
    EXPECT_LT((tangents.transpose() * normal).norm(), 1e-12);
    if (landmark.model != PlaneModel::kHorizontal) continue;
    EXPECT_EQ(tangents.col(0), Eigen::Vector3d::UnitX());
    EXPECT_EQ(tangents.col(1), Eigen::Vector3d::UnitY());
  }
}

// Points keep their distances, and these their variances.
TEST(LandmarkTest, MovesWithItsFrame) {
  const Rigid3d to_from = {
      Eigen::Quaterniond(Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitZ())), {7.0, -4.0, 1.5}};
  for (const Landmark& landmark : OneOfEach()) {
    Landmark moved = landmark;
    moved.extent.AddSegment({1.0, 2.0, 0.3}, {1.5, 2.1, 0.7});
    moved.Move(to_from);
    for (const Eigen::Vector3d& p :
         {Eigen::Vector3d(2.0, 1.0, -3.0), Eigen::Vector3d(0.5, -1.0, 1.0)}) {
      EXPECT_NEAR(moved.SignedDistance(to_from * p), landmark.SignedDistance(p), 1e-12);
      EXPECT_LT(
          (moved.NormalNear(to_from * p) - to_from.rotation * landmark.NormalNear(p)).norm(),
          1e-12);
      const Eigen::RowVector3d before =
          landmark.DeviationJacobian(p, Eigen::Vector3d::UnitX()).row(0);
      const Eigen::RowVector3d after =
          moved.DeviationJacobian(to_from * p, Eigen::Vector3d::UnitX()).row(0);
      EXPECT_NEAR(after.dot(after * moved.covariance),
                  before.dot(before * landmark.covariance),
                  1e-12);
    }
    EXPECT_TRUE(moved.extent.empty());
    EXPECT_LT((moved.extent.axes().anchor - to_from * landmark.extent.axes().anchor).norm(),
              1e-12);
    const PlaneAxes& axes = moved.extent.axes();
    EXPECT_LT((axes.u.cross(axes.v) -
               to_from.rotation * landmark.extent.axes().u.cross(landmark.extent.axes().v))
                  .norm(),
              1e-12);
  }
}

// About another origin a surface's parameters are those of the surface moved there.
TEST(LandmarkTest, ParametersAboutAnotherOriginAndBack) {
  const Eigen::Vector2d origin(20.0, -7.0);
  const Rigid3d shift = {Eigen::Quaterniond::Identity(), {-20.0, 7.0, 0.0}};
  for (const Landmark& landmark : OneOfEach()) {
    Landmark moved = landmark;
    moved.Move(shift);
    const Eigen::Vector3d about = landmark.ParametersAbout(origin);
    EXPECT_LT((about - Eigen::Vector3d(moved.parameters.data())).norm(), 1e-12);
    const Eigen::Matrix3d by_about = landmark.ByParametersAbout(origin);
    for (int i = 0; i < 3; ++i) {
      constexpr double kStep = 1e-6;
      Landmark back = landmark;
      for (int k = 0; k < 3; ++k) {
        back.parameters[static_cast<size_t>(k)] = about[k] + (k == i ? kStep : 0.0);
      }
      const Eigen::Vector3d derivative =
          (back.ParametersAbout(-origin) - Eigen::Vector3d(landmark.parameters.data())) /
          kStep;
      EXPECT_LT((by_about.col(i) - derivative).norm(), 1e-4);
    }
  }
}

}  // namespace
}  // namespace plumbline
