#include "factors/manifold/plane_model.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

namespace plumbline {
namespace {

struct Evaluated {
  Eigen::Vector3d normal;
  double distance;
};

Evaluated Evaluate(PlaneModel model, const PlaneChart& chart, const Eigen::VectorXd& params) {
  return VisitPlaneModel(model, chart, [&](const auto& plane) {
    Evaluated result;
    plane.Evaluate(params.data(), result.normal.data(), &result.distance);
    return result;
  });
}

TEST(PlaneModel, NormalsAndDistances) {
  const Evaluated floor =
      Evaluate(PlaneModel::kHorizontal, {1.0}, Eigen::VectorXd::Constant(1, -1.5));
  EXPECT_EQ(floor.normal, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(floor.distance, -1.5);

  const Evaluated ceiling =
      Evaluate(PlaneModel::kHorizontal, {-1.0}, Eigen::VectorXd::Constant(1, -1.0));
  EXPECT_EQ(ceiling.normal, -Eigen::Vector3d::UnitZ());
  EXPECT_EQ(ceiling.distance, -1.0);

  const Evaluated wall =
      Evaluate(PlaneModel::kVertical, {}, Eigen::Vector2d(std::acos(0.6), 4.0));
  EXPECT_LT((wall.normal - Eigen::Vector3d(0.6, 0.8, 0.0)).norm(), 1e-15);
  EXPECT_EQ(wall.distance, 4.0);
}

TEST(PlaneModel, GeneralPlanesTurnAboutTheirAnchor) {
  PlaneChart chart;
  chart.axes << Eigen::Vector3d::UnitY(), Eigen::Vector3d(-0.8, 0.0, 0.6),
      Eigen::Vector3d(0.6, 0.0, 0.8);
  chart.anchor = {10.0, 20.0, 30.0};
  const Evaluated founded = Evaluate(PlaneModel::kGeneral, chart, Eigen::Vector3d::Zero());
  EXPECT_LT((founded.normal - chart.axes.col(2)).norm(), 1e-15);
  EXPECT_NEAR(founded.distance, 30.0, 1e-13);

  const double slope = std::tan(0.3);
  const Evaluated turned =
      Evaluate(PlaneModel::kGeneral, chart, Eigen::Vector3d(slope, 0.0, 0.5));
  EXPECT_NEAR(turned.normal.norm(), 1.0, 1e-15);
  EXPECT_NEAR(turned.normal.dot(founded.normal), std::cos(0.3), 1e-15);
  EXPECT_NEAR(turned.normal.dot(chart.anchor) - turned.distance, -0.5, 1e-13);
}

TEST(PlaneModel, Sizes) {
  EXPECT_EQ(PlaneModelSize(PlaneModel::kHorizontal), 1);
  EXPECT_EQ(PlaneModelSize(PlaneModel::kVertical), 2);
  EXPECT_EQ(PlaneModelSize(PlaneModel::kGeneral), 3);
}

}  // namespace
}  // namespace plumbline
