#include "core/map/plane_patches.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/plane_tangents.h"
#include "core/surface/landmark_view.h"
#include "core/surface/patch_extent.h"

namespace plumbline {
namespace {

// With curvature k and distance d at its anchor a cylinder's radius is sqrt(1 + 2 k d) / |k|:
// along d the axis stays, and the surface moves. Of what the radius is by 1 / |k|, the root.
double RadiusFactor(const Landmark& cylinder) {
  return std::sqrt(1.0 + 2.0 * cylinder.Curvature() * cylinder.parameters[2]);
}

// The derivative of a cylinder's radius.
Eigen::RowVector3d RadiusByParameters(const Landmark& cylinder) {
  const double k = cylinder.Curvature();
  const double d = cylinder.parameters[2];
  const double factor = RadiusFactor(cylinder);
  Eigen::RowVector3d by_parameters = Eigen::RowVector3d::Zero();
  by_parameters[Cylinder::kCurvatureAt] = -(1.0 + k * d) / (factor * k * std::abs(k));
  by_parameters[2] = std::copysign(1.0, k) / factor;
  return by_parameters;
}

// The derivatives of what is stated of a surface by its parameters: the turns of the normal
// towards its tangents u and v, of a cylinder that towards u and the radius, and the distance
// along the normal at the patch's centre.
Eigen::Matrix3d StatedByParameters(const Landmark& landmark, const PlanePatch& patch) {
  const Eigen::Matrix<double, 3, 2> tangents = PlaneTangents(patch.normal);
  const LandmarkView view = LandmarkView(landmark).Near(patch.centre);
  Eigen::Matrix3d by_parameters;
  by_parameters.row(0) = view.DeviationJacobian(patch.centre, tangents.col(0)).row(1);
  by_parameters.row(1) = view.DeviationJacobian(patch.centre, tangents.col(1)).row(1);
  if (landmark.IsCurved()) by_parameters.row(1) = RadiusByParameters(landmark);
  by_parameters.row(2) = -view.DeviationJacobian(patch.centre, tangents.col(0)).row(0);
  return by_parameters;
}

PlaneType TypeOf(const Landmark& landmark) {
  switch (landmark.model) {
    case PlaneModel::kHorizontal:
      return PlaneType::kHorizontal;
    case PlaneModel::kVertical:
      return PlaneType::kVertical;
    case PlaneModel::kGeneral:
      return PlaneType::kGeneral;
    case PlaneModel::kCylinder:
      break;
  }
  return PlaneType::kCylinder;
}

// The corners of what was seen of a cylinder, in its extent's axes.
std::vector<Eigen::Vector2d> OutlineOnArc(const PatchExtent& extent) {
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

}  // namespace

std::vector<PlanePatch> PlanePatches(const MapState& state) {
  std::vector<PlanePatch> patches;
  for (const Landmark& landmark : state.landmarks) {
    if (landmark.num_segments == 0) continue;
    PlanePatch patch;
    patch.id = landmark.id;
    patch.type = TypeOf(landmark);
    const PatchExtent& extent = landmark.extent;
    const auto on_plane = [&](const Eigen::Vector2d& uv) -> Eigen::Vector3d {
      const Eigen::Vector3d p = extent.ToWorld(uv);
      return p - landmark.SignedDistance(p) * landmark.NormalNear(p).normalized();
    };
    patch.centre = on_plane(0.5 * (extent.min_corner() + extent.max_corner()));
    const Eigen::Vector4d plane = landmark.PlaneNear(patch.centre);
    const double gradient = plane.head<3>().norm();
    patch.normal = plane.head<3>() / gradient;
    patch.distance = landmark.IsCurved() ? patch.normal.dot(patch.centre) : plane[3];
    if (landmark.IsCurved()) patch.curvature = landmark.Curvature() / RadiusFactor(landmark);
    for (const Eigen::Vector2d& corner :
         landmark.IsCurved() ? OutlineOnArc(extent) : extent.Outline()) {
      patch.outline.push_back(on_plane(corner));
    }
    const Eigen::Matrix3d by_parameters = StatedByParameters(landmark, patch);
    const Eigen::Matrix3d covariance =
        by_parameters * landmark.covariance * by_parameters.transpose();
    patch.sigma_distance_m = std::sqrt(covariance(2, 2));
    if (landmark.IsCurved()) {
      patch.sigma_angle_rad = std::sqrt(covariance(0, 0));
      patch.sigma_radius_m = std::sqrt(covariance(1, 1));
      const double product = patch.sigma_angle_rad * patch.sigma_radius_m;
      patch.radius_turn_correlation = product > 0.0 ? covariance(0, 1) / product : 0.0;
    } else {
      // In the direction in which it is known worst.
      const Eigen::Matrix2d of_turns = covariance.topLeftCorner<2, 2>();
      patch.sigma_angle_rad = std::sqrt(std::max(
          0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(of_turns).eigenvalues()[1]));
    }
    patch.num_points = landmark.num_points;
    patch.num_segments = landmark.num_segments;
    patch.first_time_ns = landmark.first_time_ns;
    patch.last_time_ns = landmark.last_time_ns;
    patches.push_back(std::move(patch));
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
    if (landmark.model == PlaneModel::kGeneral || landmark.IsCurved()) {
      by_parameters.block<3, 3>(row, row) = StatedByParameters(landmark, patch);
    }
    row += size;
  }
  return PlaneCovariance(std::move(patches),
                         by_parameters * covariance * by_parameters.transpose());
}

}  // namespace plumbline
