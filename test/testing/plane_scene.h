#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "core/map/observation.h"
#include "core/segmentation/segmentation.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/util/time.h"

namespace plumbline {

// A plane n.p = d with free space on its positive side.
struct ScenePlane {
  Eigen::Vector3d normal;
  double distance;
};

// A convex room, as the planes around it.
using PlaneScene = std::vector<ScenePlane>;

// Walls at the given headings of their normals and distances from the vertical axis, floor and
// ceiling at the given heights.
inline PlaneScene MakeRoom(const std::vector<std::pair<double, double>>& walls,
                           double floor_height,
                           double ceiling_height) {
  PlaneScene scene;
  for (const auto& [heading, distance] : walls) {
    scene.push_back({{std::cos(heading), std::sin(heading), 0.0}, -distance});
  }
  scene.push_back({Eigen::Vector3d::UnitZ(), floor_height});
  scene.push_back({-Eigen::Vector3d::UnitZ(), -ceiling_height});
  return scene;
}

inline double CastRay(const PlaneScene& scene,
                      const Eigen::Vector3d& origin,
                      const Eigen::Vector3d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const ScenePlane& plane : scene) {
    const double slope = plane.normal.dot(direction);
    if (slope >= -1e-9) continue;
    nearest = std::min(nearest, (plane.distance - plane.normal.dot(origin)) / slope);
  }
  return nearest;
}

// One scan line of a scanner on a body that moves as told, with range noise of sigma_m.
inline ScanLine TakeScanLine(const PlaneScene& scene,
                             const Scanner& scanner,
                             int scanner_index,
                             int64_t stamp_ns,
                             const std::function<Rigid3d(int64_t)>& world_from_body,
                             double sigma_m,
                             std::mt19937_64* random) {
  ScanLine line;
  line.scanner_index = scanner_index;
  line.stamp_ns = stamp_ns;
  const double field_of_view = scanner.field_of_view_deg * M_PI / 180.0;
  line.angle_min = -0.5 * field_of_view;
  line.angle_increment = field_of_view / (scanner.beams - 1);
  line.time_increment_s = 0.75 / scanner.scan_rate_hz / scanner.beams;
  std::normal_distribution<double> noise(0.0, 1.0);
  for (int beam = 0; beam < scanner.beams; ++beam) {
    const Rigid3d world_from_scanner =
        world_from_body(line.BeamTime(beam)) * scanner.BodyFromScanner(line.BeamTime(beam));
    const Eigen::Vector2d direction = line.BeamDirection(beam);
    const double range = CastRay(
        scene,
        world_from_scanner.translation,
        world_from_scanner.rotation * Eigen::Vector3d(direction.x(), direction.y(), 0.0));
    line.ranges.push_back(static_cast<float>(range + sigma_m * noise(*random)));
  }
  return line;
}

// The beams first .. last as the trace of the plane, for a body at rest.
inline Observation ObservePlane(const ScanLine& line,
                                const Scanner& scanner,
                                const Rigid3d& world_from_body,
                                const ScenePlane& plane,
                                int first_beam,
                                int last_beam) {
  Segment segment;
  segment.first_beam = first_beam;
  segment.last_beam = last_beam;
  segment.num_points = last_beam - first_beam + 1;
  const Eigen::Vector3d normal =
      (world_from_body * scanner.body_from_scanner).rotation.conjugate() * plane.normal;
  segment.normal = normal.head<2>().normalized();
  const auto point = [&](int beam) -> Eigen::Vector2d {
    return line.ranges[static_cast<size_t>(beam)] * line.BeamDirection(beam);
  };
  segment.sigma_offset_m = scanner.range_noise_m / std::sqrt(segment.num_points);
  const double length = (point(last_beam) - point(first_beam)).norm();
  segment.sigma_direction_rad =
      scanner.range_noise_m * std::sqrt(12.0 / segment.num_points) / length;
  return MakeObservation(line, scanner, segment, true);
}

// The paper's rig, or one like it: one level scanner, two tilted ones.
inline Rig MakePaperRig() {
  Rig rig;
  rig.scanners.resize(3);
  const double degree = M_PI / 180.0;
  rig.scanners[0].body_from_scanner = {RotationFromRollPitchYaw(0.0, 0.0, -90.0 * degree),
                                       {0.0, 0.0, 0.12}};
  rig.scanners[1].body_from_scanner = {
      RotationFromRollPitchYaw(0.0, 45.0 * degree, 45.0 * degree), {0.0, 0.1, 0.0}};
  rig.scanners[2].body_from_scanner = {
      RotationFromRollPitchYaw(0.0, -45.0 * degree, 135.0 * degree), {0.0, -0.1, 0.0}};
  for (size_t i = 0; i < 3; ++i) {
    rig.scanners[i].name = "scanner" + std::to_string(i);
    rig.scanners[i].topic = "/scan" + std::to_string(i);
  }
  return rig;
}

}  // namespace plumbline
