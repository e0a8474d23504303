#include "core/map/plane_patches.h"

#include <cmath>
#include <utility>

#include "core/map/patch_extent.h"

namespace plumbline {

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
    const Eigen::Matrix2d by_plane =
        landmark.DeviationJacobian(patch.centre, landmark.extent.u_axis());
    const Eigen::Matrix2d covariance = by_plane * landmark.covariance * by_plane.transpose();
    patch.sigma_distance_m = std::sqrt(covariance(0, 0));
    patch.sigma_angle_rad = std::sqrt(covariance(1, 1));
    patch.num_points = landmark.num_points;
    patch.num_segments = landmark.num_segments;
    patch.first_time_ns = landmark.first_time_ns;
    patch.last_time_ns = landmark.last_time_ns;
    patches.push_back(std::move(patch));
  }
  return patches;
}

}  // namespace plumbline
