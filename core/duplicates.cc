#include "core/duplicates.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/association.h"

namespace plumbline {
namespace {

bool AreOnePlane(const Landmark& a,
                 const Landmark& b,
                 double range_noise_m,
                 const AssociationOptions& options) {
  if (a.model != b.model || a.Normal().dot(b.Normal()) < 0.8) return false;
  if (!a.extent.IsNear(b.extent, options.max_gap_m)) return false;
  // Compared at the middle of the smaller one, along its longer side.
  const PatchExtent& extent = b.extent;
  const Eigen::Vector2d size = extent.max_corner() - extent.min_corner();
  const Eigen::Vector2d middle = 0.5 * (extent.max_corner() + extent.min_corner());
  const bool along_u = a.model == PlaneModel::kVertical || size.x() > size.y();
  const Eigen::Vector3d direction = along_u ? extent.u_axis() : extent.v_axis();
  const Eigen::Vector3d on_axes = middle.x() * extent.u_axis() + middle.y() * extent.v_axis();
  const Eigen::Vector3d point = on_axes - b.SignedDistance(on_axes) * b.Normal();
  const Eigen::Vector2d difference(a.SignedDistance(point),
                                   a.Normal().dot(direction) - b.Normal().dot(direction));
  const Eigen::Matrix2d by_a = a.DeviationJacobian(point, direction);
  const Eigen::Matrix2d by_b = b.DeviationJacobian(point, direction);
  const Eigen::Matrix2d covariance =
      by_a * a.covariance * by_a.transpose() + by_b * b.covariance * by_b.transpose();
  if (covariance(0, 0) > range_noise_m * range_noise_m) return false;
  const Eigen::Matrix2d total =
      covariance +
      2.0 * FlatnessCovariance(along_u ? size.x() : size.y(), options.surface_flatness_m);
  return difference.dot(total.inverse() * difference) <
         TwoDegreesQuantile(options.significance);
}

}  // namespace

std::vector<std::pair<int, int>> FindDuplicates(const Rig& rig,
                                                const MapState& state,
                                                const MapperOptions& options,
                                                int since_scan) {
  double range_noise_m = 0.0;
  for (const Scanner& scanner : rig.scanners) {
    range_noise_m = std::max(range_noise_m, scanner.range_noise_m);
  }
  std::vector<std::pair<int, int>> pairs;
  for (const Landmark& newer : state.landmarks) {
    if (newer.num_segments == 0) continue;
    for (const Landmark& older : state.landmarks) {
      if (older.id >= newer.id) break;
      if (older.num_segments == 0) continue;
      if (std::max(newer.last_scan, older.last_scan) < since_scan) continue;
      if (!IsWithinGap(older, newer.first_scan, options.loop_closure)) continue;
      const bool newer_is_smaller = newer.extent.area_m2() < older.extent.area_m2();
      if (AreOnePlane(newer_is_smaller ? older : newer,
                      newer_is_smaller ? newer : older,
                      range_noise_m,
                      options.association)) {
        pairs.emplace_back(older.id, newer.id);
        break;
      }
    }
  }
  return pairs;
}

void MergeInto(int into_id, int from_id, MapState* state) {
  Landmark& into = state->landmarks[static_cast<size_t>(into_id)];
  Landmark& from = state->landmarks[static_cast<size_t>(from_id)];
  for (Observation& observation : state->observations) {
    if (observation.landmark_id == from_id) observation.landmark_id = into_id;
  }
  into.extent.Merge(from.extent);
  into.first_scan = std::min(into.first_scan, from.first_scan);
  into.last_scan = std::max(into.last_scan, from.last_scan);
  into.first_time_ns = std::min(into.first_time_ns, from.first_time_ns);
  into.last_time_ns = std::max(into.last_time_ns, from.last_time_ns);
  into.num_segments += from.num_segments;
  into.num_points += from.num_points;
  from.num_segments = 0;
  from.num_points = 0;
  from.extent = PatchExtent(from.extent.u_axis(), from.extent.v_axis());
}

}  // namespace plumbline
