#include "core/surface/landmark.h"

#include <ceres/jet.h>
#include <glog/logging.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "core/geometry/plane_tangents.h"
#include "core/surface/landmark_view.h"
#include "core/surface/patch_extent.h"

namespace plumbline {
bool Landmark::IsJudged() const {
  constexpr int kMaxJudged = 200;  // their mean is known to a fourteenth
  return num_judged >= kMaxJudged;
}

bool Landmark::AgreesWithin(double mean_deviation) const {
  // One more segment, as good as expected: so that one alone, or none, does not decide.
  return sum_deviations <= mean_deviation * num_judged + kExpectedDeviation;
}

void Landmark::TakeShapeOf(const Landmark& other) {
  model = other.model;
  chart = other.chart;
  parameters = other.parameters;
  covariance = other.covariance;
  extent = other.extent;
}

Eigen::Vector4d Landmark::PlaneNear(const Eigen::Vector3d& p_world) const {
  Eigen::Vector4d plane;
  VisitPlaneModel(model, chart, [&](const auto& parametrised) {
    EvaluateNear(
        parametrised, parameters.data(), p_world.data(), plane.data(), plane.data() + 3);
  });
  return plane;
}

PatchExtent Landmark::EmptyExtent() const {
  const Eigen::Vector3d normal = NormalNear(extent.axes().anchor).normalized();
  const Eigen::Vector3d anchor =
      extent.axes().anchor - SignedDistance(extent.axes().anchor) * normal;
  if (model == PlaneModel::kHorizontal) {
    return PatchExtent(anchor, extent.axes().u, extent.axes().v);
  }
  const Eigen::Matrix<double, 3, 2> tangents = PlaneTangents(normal);
  return PatchExtent(anchor, tangents.col(0), tangents.col(1), Curvature());
}

Eigen::Matrix<double, 2, 3> Landmark::DeviationJacobian(
    const Eigen::Vector3d& p_world, const Eigen::Vector3d& direction_world) const {
  return LandmarkView(*this).Near(p_world).DeviationJacobian(p_world, direction_world);
}

void Landmark::SetPlane(const Eigen::Vector3d& normal, double distance) {
  switch (model) {
    case PlaneModel::kHorizontal:
      parameters[0] = distance;
      return;
    case PlaneModel::kVertical:
      parameters[0] = std::atan2(normal.y(), normal.x());
      parameters[1] = distance;
      return;
    case PlaneModel::kCylinder:
      LOG(FATAL) << "landmark " << id << " is a cylinder";
    case PlaneModel::kGeneral:
      break;
  }
  const Eigen::Vector3d in_chart = chart.axes.transpose() * normal;
  parameters[0] = in_chart.x() / in_chart.z();
  parameters[1] = in_chart.y() / in_chart.z();
  parameters[2] = distance - normal.dot(chart.anchor);
}

Eigen::Matrix<double, 4, 3> Landmark::PlaneByParameters(const Eigen::Vector3d& p_world) const {
  Eigen::Matrix<double, 4, 3> by_parameters = Eigen::Matrix<double, 4, 3>::Zero();
  VisitPlaneModel(model, chart, [&](const auto& plane) {
    constexpr int kSize = std::decay_t<decltype(plane)>::kSize;
    using T = ceres::Jet<double, kSize>;
    T jets[kSize];
    for (int i = 0; i < kSize; ++i) jets[i] = T(parameters[static_cast<size_t>(i)], i);
    T of_plane[4];
    EvaluateNear(plane, jets, p_world.data(), of_plane, of_plane + 3);
    for (int i = 0; i < 4; ++i) {
      by_parameters.template block<1, kSize>(i, 0) = of_plane[i].v.transpose();
    }
  });
  return by_parameters;
}

Landmark MakeHorizontalLandmark(double sign, const Eigen::Vector3d& p_world) {
  Landmark landmark;
  landmark.model = PlaneModel::kHorizontal;
  landmark.chart.sign = sign;
  landmark.parameters[0] = sign * p_world.z();
  landmark.extent = PatchExtent(p_world, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY());
  return landmark;
}

Landmark MakeGeneralLandmark(const Eigen::Vector3d& normal_world,
                             const Eigen::Vector3d& p_world) {
  Landmark landmark;
  landmark.model = PlaneModel::kGeneral;
  landmark.chart.axes << PlaneTangents(normal_world), normal_world;
  landmark.chart.anchor = p_world;
  landmark.extent =
      PatchExtent(p_world, landmark.chart.axes.col(0), landmark.chart.axes.col(1));
  return landmark;
}

Landmark MakeCylinderLandmark(const Eigen::Vector3d& normal_world,
                              double curvature,
                              const Eigen::Vector3d& p_world) {
  Landmark landmark;
  landmark.model = PlaneModel::kCylinder;
  landmark.chart.anchor = p_world;
  landmark.parameters[0] = std::atan2(normal_world.y(), normal_world.x());
  landmark.parameters[Cylinder::kCurvatureAt] = curvature;
  landmark.extent = PatchExtent(p_world,
                                Eigen::Vector3d::UnitZ().cross(landmark.Normal()),
                                Eigen::Vector3d::UnitZ(),
                                curvature);
  return landmark;
}

Landmark MakeVerticalLandmark(const Eigen::Vector3d& normal_world,
                              const Eigen::Vector3d& p_world) {
  Landmark landmark;
  landmark.model = PlaneModel::kVertical;
  const double angle = std::atan2(normal_world.y(), normal_world.x());
  const Eigen::Vector3d normal(std::cos(angle), std::sin(angle), 0.0);
  landmark.parameters[0] = angle;
  landmark.parameters[1] = normal.dot(p_world);
  landmark.extent =
      PatchExtent(p_world, Eigen::Vector3d::UnitZ().cross(normal), Eigen::Vector3d::UnitZ());
  return landmark;
}

}  // namespace plumbline
