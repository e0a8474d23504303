#include "core/association/tentative_plane.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "core/surface/patch_extent.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// The length of a plane's sides that tells it from somebody who walks, m: he is as high as a
// wall piece, but not as wide.
template <typename Surface>
double LengthOf(const Surface&, const Eigen::Vector2d& sides) {
  return sides.norm();
}
double LengthOf(const VerticalPlane&, const Eigen::Vector2d& sides) { return sides.x(); }
double LengthOf(const Cylinder&, const Eigen::Vector2d& sides) { return sides.x(); }

}  // namespace

void TentativePlane::Count(const Observation& observation,
                           int observation_index,
                           const ObservationPoses& poses,
                           const MeasuredLine& line) {
  if (observations.empty()) {
    first_position = poses.world_from_body.translation;
    first_time_ns = observation.start_time_ns();
    first_line = line;
  }
  last_position = poses.world_from_body.translation;
  last_time_ns = observation.end_time_ns();
  observations.push_back(observation_index);
  scans.insert(observation.scan_index);
  scanners.insert(observation.scanner_index);
  lines.Add(line);
  swept_m = std::max(swept_m,
                     (line.centroid_world - first_line.centroid_world)
                         .cross(first_line.direction_world)
                         .norm());
}

bool TentativePlane::HasAge(const PlaneOptions& options) const {
  const PatchExtent& extent = landmark.extent;
  const Eigen::Vector2d sides = extent.max_corner() - extent.min_corner();
  const double length_m = VisitPlaneModel(
      landmark.model, landmark.chart, [&](const auto& kind) { return LengthOf(kind, sides); });
  if (length_m > options.small_m) return true;
  return SecondsBetween(first_time_ns, last_time_ns) > options.min_age_of_small_s;
}

}  // namespace plumbline
