#include "core/map/plane_patches.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/plane_tangents.h"
#include "core/map/landmark_view.h"
#include "core/map/patch_extent.h"

namespace plumbline {
namespace {

// The derivatives of what is stated of a plane by its parameters: the turns of the normal
// towards its tangents u and v, and the distance along the normal at the patch's centre.
Eigen::Matrix3d StatedByParameters(const Landmark& landmark, const PlanePatch& patch) {
  const Eigen::Matrix<double, 3, 2> tangents = PlaneTangents(patch.normal);
  const LandmarkView view(landmark);
  Eigen::Matrix3d by_parameters;
  by_parameters.row(0) = view.DeviationJacobian(patch.centre, tangents.col(0)).row(1);
  by_parameters.row(1) = view.DeviationJacobian(patch.centre, tangents.col(1)).row(1);
  by_parameters.row(2) = -view.DeviationJacobian(patch.centre, tangents.col(0)).row(0);
  return by_parameters;
}

}  // namespace

std::vector<PlanePatch> PlanePatches(const MapState& state) {
  std::vector<PlanePatch> patches;
  for (const Landmark& landmark : state.landmarks) {
    if (landmark.num_segments == 0) continue;
    PlanePatch patch;
    patch.id = landmark.id;
    patch.type = landmark.model == PlaneModel::kHorizontal ? PlaneType::kHorizontal
                 : landmark.model == PlaneModel::kVertical ? PlaneType::kVertical
                                                           : PlaneType::kGeneral;
    patch.normal = landmark.Normal();
    patch.distance = landmark.Distance();
    const PatchExtent& extent = landmark.extent;
    const auto on_plane = [&](const Eigen::Vector2d& uv) -> Eigen::Vector3d {
      const Eigen::Vector3d p = extent.ToWorld(uv);
      return p - patch.SignedDistance(p) * patch.normal;
    };
    patch.centre = on_plane(0.5 * (extent.min_corner() + extent.max_corner()));
    for (const Eigen::Vector2d& corner : extent.Outline()) {
      patch.outline.push_back(on_plane(corner));
    }
    const Eigen::Matrix3d by_parameters = StatedByParameters(landmark, patch);
    const Eigen::Matrix3d covariance =
        by_parameters * landmark.covariance * by_parameters.transpose();
    patch.sigma_distance_m = std::sqrt(covariance(2, 2));
    // In the direction in which it is known worst.
    const Eigen::Matrix2d of_turns = covariance.topLeftCorner<2, 2>();
    patch.sigma_angle_rad = std::sqrt(std::max(
        0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(of_turns).eigenvalues()[1]));
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
    if (landmark.model == PlaneModel::kGeneral) {
      by_parameters.block<3, 3>(row, row) = StatedByParameters(landmark, patch);
    }
    row += size;
  }
  return PlaneCovariance(std::move(patches),
                         by_parameters * covariance * by_parameters.transpose());
}

}  // namespace plumbline
