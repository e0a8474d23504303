#include "core/surface/landmark.h"

#include <ceres/jet.h>
#include <glog/logging.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include "core/surface/landmark_view.h"
#include "core/surface/patch_extent.h"

namespace plumbline {
namespace {

using Parameters = std::array<double, 3>;

// What each kind of surface answers.

// The direction of the parameter that is the distance from the world's origin; zero of
// surfaces whose parameters are about their chart's anchor.
template <typename Surface>
Eigen::Vector3d AlongDistance(const Surface&) {
  return Eigen::Vector3d::Zero();
}
Eigen::Vector3d AlongDistance(const HorizontalPlane&) { return Eigen::Vector3d::UnitX(); }
Eigen::Vector3d AlongDistance(const VerticalPlane&) { return Eigen::Vector3d::UnitY(); }

Parameters ParametersOf(const HorizontalPlane&, const Eigen::Vector3d&, double distance) {
  return {distance};
}
Parameters ParametersOf(const VerticalPlane&, const Eigen::Vector3d& normal, double distance) {
  return {std::atan2(normal.y(), normal.x()), distance};
}
Parameters ParametersOf(const GeneralPlane& plane,
                        const Eigen::Vector3d& normal,
                        double distance) {
  const Eigen::Vector3d in_chart = plane.axes.transpose() * normal;
  return {in_chart.x() / in_chart.z(),
          in_chart.y() / in_chart.z(),
          distance - normal.dot(plane.anchor)};
}
Parameters ParametersOf(const Cylinder&, const Eigen::Vector3d&, double) {
  LOG(FATAL) << "a cylinder is no plane";
}

// Turns the heading of surfaces that have one to that of their normal at the chart's anchor.
template <typename Surface>
void TurnTo(const Surface&, const Eigen::Vector3d&, Parameters*) {}
void TurnTo(const VerticalPlane&, const Eigen::Vector3d& normal, Parameters* parameters) {
  parameters->front() = std::atan2(normal.y(), normal.x());
}
void TurnTo(const Cylinder&, const Eigen::Vector3d& normal, Parameters* parameters) {
  parameters->front() = std::atan2(normal.y(), normal.x());
}

// Of the sides of what has been seen, along the extent's axes.
template <typename Surface>
double WidthOf(const Surface&, const Eigen::Vector2d& sides) {
  return sides.x();
}
double WidthOf(const HorizontalPlane&, const Eigen::Vector2d& sides) {
  return sides.minCoeff();
}

SurfaceTraits TraitsOf(const HorizontalPlane&) {
  SurfaceTraits traits;
  traits.goes_on_behind_walls = true;
  traits.passes_for_wall = true;
  return traits;
}
SurfaceTraits TraitsOf(const VerticalPlane&) {
  SurfaceTraits traits;
  traits.has_heading = true;
  traits.bounds_floors = true;
  traits.has_doorways = true;
  traits.may_bend = true;
  return traits;
}
SurfaceTraits TraitsOf(const GeneralPlane&) {
  SurfaceTraits traits;
  traits.has_soft_edges = true;
  traits.passes_for_wall = true;
  return traits;
}
SurfaceTraits TraitsOf(const Cylinder&) {
  SurfaceTraits traits;
  traits.bounds_floors = true;
  traits.has_soft_edges = true;
  traits.may_bend = true;
  return traits;
}

}  // namespace

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

Eigen::Vector3d Landmark::AlongDistance() const {
  return VisitPlaneModel(
      model, chart, [](const auto& kind) { return plumbline::AlongDistance(kind); });
}

void Landmark::Move(const Rigid3d& to_from) {
  const Eigen::Vector3d normal = to_from.rotation * Normal();
  const Eigen::Vector3d along = Eigen::Vector3d::UnitZ().cross(normal);
  chart.axes = to_from.rotation * chart.axes;
  chart.anchor = to_from * chart.anchor;
  VisitPlaneModel(model, chart, [&](const auto& kind) { TurnTo(kind, normal, &parameters); });
  Eigen::Map<Eigen::Vector3d> of_surface(parameters.data());
  of_surface += normal.dot(to_from.translation) * AlongDistance();
  // The distance from the new origin changes with the angle.
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  jacobian.col(0) += along.dot(to_from.translation) * AlongDistance();
  covariance = jacobian * covariance * jacobian.transpose();
  const PlaneAxes& axes = extent.axes();
  extent = PatchExtent(to_from * axes.anchor,
                       to_from.rotation * axes.u,
                       to_from.rotation * axes.v,
                       axes.curvature);
}

Eigen::Vector3d Landmark::ParametersAbout(const Eigen::Vector2d& origin) const {
  return Eigen::Vector3d(parameters.data()) - Normal().head<2>().dot(origin) * AlongDistance();
}

Eigen::Matrix3d Landmark::ByParametersAbout(const Eigen::Vector2d& origin) const {
  return Eigen::Matrix3d::Identity() +
         AlongDistance() * (origin.transpose() * PlaneByParameters().topRows<2>());
}

Eigen::Vector4d Landmark::PlaneNear(const Eigen::Vector3d& p_world) const {
  Eigen::Vector4d plane;
  VisitPlaneModel(model, chart, [&](const auto& parametrised) {
    EvaluateNear(
        parametrised, parameters.data(), p_world.data(), plane.data(), plane.data() + 3);
  });
  return plane;
}

double Landmark::Width() const {
  const Eigen::Vector2d sides = extent.max_corner() - extent.min_corner();
  return VisitPlaneModel(model, chart, [&](const auto& kind) { return WidthOf(kind, sides); });
}

PatchExtent Landmark::EmptyExtent() const {
  const Eigen::Vector3d normal = NormalNear(extent.axes().anchor).normalized();
  const Eigen::Vector3d anchor =
      extent.axes().anchor - SignedDistance(extent.axes().anchor) * normal;
  const Eigen::Matrix<double, 3, 2> tangents = Tangents(normal);
  return PatchExtent(anchor, tangents.col(0), tangents.col(1), Curvature());
}

Eigen::Matrix<double, 2, 3> Landmark::DeviationJacobian(
    const Eigen::Vector3d& p_world, const Eigen::Vector3d& direction_world) const {
  std::optional<LandmarkView> near;
  return LandmarkView(*this).Near(p_world, &near).DeviationJacobian(p_world, direction_world);
}

void Landmark::SetPlane(const Eigen::Vector3d& normal, double distance) {
  parameters = VisitPlaneModel(
      model, chart, [&](const auto& kind) { return ParametersOf(kind, normal, distance); });
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

SurfaceTraits TraitsOf(const Landmark& landmark) {
  return VisitPlaneModel(
      landmark.model, landmark.chart, [](const auto& kind) { return TraitsOf(kind); });
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
