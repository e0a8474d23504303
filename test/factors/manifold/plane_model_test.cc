#include "factors/manifold/plane_model.h"

#include <gtest/gtest.h>

#include <Eigen/Core>

namespace plumbline {
namespace {

struct Evaluated {
  Eigen::Vector3d normal;
  double distance;
};

Evaluated Evaluate(PlaneModel model, double sign, const Eigen::VectorXd& params) {
  return VisitPlaneModel(model, sign, [&](const auto& plane) {
    Evaluated result;
    plane.Evaluate(params.data(), result.normal.data(), &result.distance);
    return result;
  });
}

TEST(PlaneModel, NormalsAndDistances) {
  const Evaluated floor =
      Evaluate(PlaneModel::kHorizontal, 1.0, Eigen::VectorXd::Constant(1, -1.5));
  EXPECT_EQ(floor.normal, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(floor.distance, -1.5);

  const Evaluated ceiling =
      Evaluate(PlaneModel::kHorizontal, -1.0, Eigen::VectorXd::Constant(1, -1.0));
  EXPECT_EQ(ceiling.normal, -Eigen::Vector3d::UnitZ());
  EXPECT_EQ(ceiling.distance, -1.0);

  const Evaluated wall =
      Evaluate(PlaneModel::kVertical, 1.0, Eigen::Vector2d(std::acos(0.6), 4.0));
  EXPECT_LT((wall.normal - Eigen::Vector3d(0.6, 0.8, 0.0)).norm(), 1e-15);
  EXPECT_EQ(wall.distance, 4.0);

  const Evaluated ramp =
      Evaluate(PlaneModel::kGeneral, 1.0, Eigen::Vector4d(0.6, 0.0, 0.8, 2.0));
  EXPECT_EQ(ramp.normal, Eigen::Vector3d(0.6, 0.0, 0.8));
  EXPECT_EQ(ramp.distance, 2.0);
}

TEST(PlaneModel, Sizes) {
  EXPECT_EQ(PlaneModelSize(PlaneModel::kHorizontal), 1);
  EXPECT_EQ(PlaneModelSize(PlaneModel::kVertical), 2);
  EXPECT_EQ(PlaneModelSize(PlaneModel::kGeneral), 4);
  EXPECT_EQ(PlaneModelTangentSize(PlaneModel::kHorizontal), 1);
  EXPECT_EQ(PlaneModelTangentSize(PlaneModel::kVertical), 2);
  EXPECT_EQ(PlaneModelTangentSize(PlaneModel::kGeneral), 3);
}

}  // namespace
}  // namespace plumbline
