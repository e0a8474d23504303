#include "core/surface/plane_patches.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/geometry/plane_tangents.h"
#include "core/surface/landmark_view.h"
#include "core/surface/patch_extent.h"

namespace plumbline {
namespace {

// With curvature k and distance d at its anchor a cylinder's radius is sqrt(1 + 2 k d) / |k|:
// along d the axis stays, and the surface moves. Of what the radius is by 1 / |k|, the root; 1
// of a plane.
double RadiusFactor(const Landmark& landmark) {
  return std::sqrt(1.0 + 2.0 * landmark.Curvature() * landmark.parameters[2]);
}

// The derivatives of the turns of the normal towards its tangents u and v, and of the distance
// along the normal at the patch's centre, by the parameters.
Eigen::Matrix3d PoseByParameters(const Landmark& landmark, const PlanePatch& patch) {
  const Eigen::Matrix<double, 3, 2> tangents = PlaneTangents(patch.normal);
  const LandmarkView view(landmark);
  std::optional<LandmarkView> near;
  const LandmarkView& plane = view.Near(patch.centre, &near);
  Eigen::Matrix3d by_parameters;
  by_parameters.row(0) = plane.DeviationJacobian(patch.centre, tangents.col(0)).row(1);
  by_parameters.row(1) = plane.DeviationJacobian(patch.centre, tangents.col(1)).row(1);
  by_parameters.row(2) = -plane.DeviationJacobian(patch.centre, tangents.col(0)).row(0);
  return by_parameters;
}

// What each kind of surface states.

PlaneType TypeOf(const HorizontalPlane&) { return PlaneType::kHorizontal; }
PlaneType TypeOf(const VerticalPlane&) { return PlaneType::kVertical; }
PlaneType TypeOf(const GeneralPlane&) { return PlaneType::kGeneral; }
PlaneType TypeOf(const Cylinder&) { return PlaneType::kCylinder; }

// The distance of the plane that is stated: of a cylinder of its tangent plane at the centre.
template <typename Plane>
double DistanceOf(const Plane&, const Eigen::Vector4d& plane, const PlanePatch&) {
  return plane[3];
}
double DistanceOf(const Cylinder&, const Eigen::Vector4d&, const PlanePatch& patch) {
  return patch.normal.dot(patch.centre);
}

// The corners of what was seen, in the extent's axes.
template <typename Plane>
std::vector<Eigen::Vector2d> OutlineOf(const Plane&, const PatchExtent& extent) {
  return extent.Outline();
}
std::vector<Eigen::Vector2d> OutlineOf(const Cylinder&, const PatchExtent& extent) {
  constexpr double kStep = 0.1;  // m, along the arc
  const double low = extent.min_corner().x();
  const double high = extent.max_corner().x();
  const int num_steps = std::max(1, static_cast<int>(std::ceil((high - low) / kStep)));
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i <= num_steps; ++i) {
    corners.emplace_back(low + (high - low) * i / num_steps, extent.min_corner().y());
  }
  for (int i = num_steps; i >= 0; --i) {
    corners.emplace_back(low + (high - low) * i / num_steps, extent.max_corner().y());
  }
  return corners;
}

// The derivatives of the two turns and the distance; of a cylinder the radius stands for the
// second turn.
template <typename Plane>
Eigen::Matrix3d ShapeByParameters(const Plane&,
                                  const Landmark& landmark,
                                  const PlanePatch& patch) {
  return PoseByParameters(landmark, patch);
}
Eigen::Matrix3d ShapeByParameters(const Cylinder&,
                                  const Landmark& landmark,
                                  const PlanePatch& patch) {
  const double k = landmark.Curvature();
  const double d = landmark.parameters[2];
  const double factor = RadiusFactor(landmark);
  Eigen::Matrix3d by_parameters = PoseByParameters(landmark, patch);
  by_parameters.row(1) << 0.0, -(1.0 + k * d) / (factor * k * std::abs(k)),
      std::copysign(1.0, k) / factor;
  return by_parameters;
}

// Of a horizontal or vertical plane its parameters themselves are stated.
template <typename Plane>
Eigen::MatrixXd StatedByParameters(const Plane& plane,
                                   const Landmark& landmark,
                                   const PlanePatch& patch) {
  return ShapeByParameters(plane, landmark, patch);
}
Eigen::MatrixXd StatedByParameters(const HorizontalPlane&,
                                   const Landmark&,
                                   const PlanePatch&) {
  return Eigen::MatrixXd::Identity(HorizontalPlane::kSize, HorizontalPlane::kSize);
}
Eigen::MatrixXd StatedByParameters(const VerticalPlane&, const Landmark&, const PlanePatch&) {
  return Eigen::MatrixXd::Identity(VerticalPlane::kSize, VerticalPlane::kSize);
}

// Sets what is stated of the first two, given their covariance.
template <typename Plane>
void SetSigmas(const Plane&, const Eigen::Matrix2d& of_turns, PlanePatch* patch) {
  // In the direction in which it is known worst.
  patch->sigma_angle_rad = std::sqrt(std::max(
      0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(of_turns).eigenvalues()[1]));
}
void SetSigmas(const Cylinder&, const Eigen::Matrix2d& covariance, PlanePatch* patch) {
  patch->sigma_angle_rad = std::sqrt(covariance(0, 0));
  patch->sigma_radius_m = std::sqrt(covariance(1, 1));
  const double product = patch->sigma_angle_rad * patch->sigma_radius_m;
  patch->radius_turn_correlation = product > 0.0 ? covariance(0, 1) / product : 0.0;
}

PlanePatch PatchOf(const Landmark& landmark) {
  PlanePatch patch;
  patch.id = landmark.id;
  const PatchExtent& extent = landmark.extent;
  const auto on_surface = [&](const Eigen::Vector2d& uv) -> Eigen::Vector3d {
    const Eigen::Vector3d p = extent.ToWorld(uv);
    return p - landmark.SignedDistance(p) * landmark.NormalNear(p).normalized();
  };
  patch.centre = on_surface(0.5 * (extent.min_corner() + extent.max_corner()));
  const Eigen::Vector4d plane = landmark.PlaneNear(patch.centre);
  patch.normal = plane.head<3>() / plane.head<3>().norm();
  patch.curvature = landmark.Curvature() / RadiusFactor(landmark);
  VisitPlaneModel(landmark.model, landmark.chart, [&](const auto& kind) {
    patch.type = TypeOf(kind);
    patch.distance = DistanceOf(kind, plane, patch);
    for (const Eigen::Vector2d& corner : OutlineOf(kind, extent)) {
      patch.outline.push_back(on_surface(corner));
    }
    const Eigen::Matrix3d by_parameters = ShapeByParameters(kind, landmark, patch);
    const Eigen::Matrix3d covariance =
        by_parameters * landmark.covariance * by_parameters.transpose();
    patch.sigma_distance_m = std::sqrt(covariance(2, 2));
    SetSigmas(kind, covariance.topLeftCorner<2, 2>(), &patch);
  });
  patch.num_points = landmark.num_points;
  patch.num_segments = landmark.num_segments;
  patch.first_time_ns = landmark.first_time_ns;
  patch.last_time_ns = landmark.last_time_ns;
  return patch;
}

}  // namespace

std::vector<PlanePatch> PlanePatches(const std::deque<Landmark>& landmarks) {
  std::vector<PlanePatch> patches;
  for (const Landmark& landmark : landmarks) {
    if (landmark.num_segments > 0) patches.push_back(PatchOf(landmark));
  }
  return patches;
}

PlaneCovariance StatedCovariance(const std::deque<Landmark>& landmarks,
                                 std::vector<PlanePatch> patches,
                                 const Eigen::MatrixXd& covariance) {
  Eigen::MatrixXd by_parameters =
      Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols());
  Eigen::Index row = 0;
  for (const PlanePatch& patch : patches) {
    const Landmark& landmark = landmarks[static_cast<size_t>(patch.id)];
    const Eigen::Index size = landmark.num_parameters();
    by_parameters.block(row, row, size, size) =
        VisitPlaneModel(landmark.model, landmark.chart, [&](const auto& kind) {
          return StatedByParameters(kind, landmark, patch);
        });
    row += size;
  }
  return PlaneCovariance(std::move(patches),
                         by_parameters * covariance * by_parameters.transpose());
}

}  // namespace plumbline
