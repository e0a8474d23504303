#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/segmentation/segmentation.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/sensor/scanner_motion.h"

namespace plumbline {

// A plane world of straight walls and round columns, as one scan plane cuts it.
struct PlanarWorld {
  struct Wall {
    Eigen::Vector2d start, end;
  };
  struct Column {
    Eigen::Vector2d centre;
    double radius;
  };
  std::vector<Wall> walls;
  std::vector<Column> columns;

  PlanarWorld& AddWalls(const std::vector<Eigen::Vector2d>& polyline) {
    for (size_t i = 0; i + 1 < polyline.size(); ++i) {
      walls.push_back({polyline[i], polyline[i + 1]});
    }
    return *this;
  }

  // Infinity if the ray meets nothing. Writes the index of the wall it meets, -1 if none.
  double CastRay(const Eigen::Vector2d& origin,
                 const Eigen::Vector2d& direction,
                 int* wall_index = nullptr) const {
    double nearest = std::numeric_limits<double>::infinity();
    if (wall_index != nullptr) *wall_index = -1;
    const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
      return a.x() * b.y() - a.y() * b.x();
    };
    for (size_t i = 0; i < walls.size(); ++i) {
      const Eigen::Vector2d along = walls[i].end - walls[i].start;
      const Eigen::Vector2d to_start = walls[i].start - origin;
      const double denominator = cross(direction, along);
      if (denominator == 0.0) continue;
      const double range = cross(to_start, along) / denominator;
      const double position = cross(to_start, direction) / denominator;
      if (range <= 0.0 || range >= nearest || position < 0.0 || position > 1.0) continue;
      nearest = range;
      if (wall_index != nullptr) *wall_index = static_cast<int>(i);
    }
    for (const Column& column : columns) {
      const Eigen::Vector2d to_centre = column.centre - origin;
      const double along = direction.dot(to_centre);
      const double square =
          column.radius * column.radius - (to_centre.squaredNorm() - along * along);
      if (square <= 0.0) continue;
      const double range = along - std::sqrt(square);
      if (range <= 0.0 || range >= nearest) continue;
      nearest = range;
      if (wall_index != nullptr) *wall_index = -1;
    }
    return nearest;
  }
};

// A scan line with the exact ranges, taken while the scanner moves. The pose at the middle
// time of the scan line is position and heading; `motion` is a constant twist about it.
struct PlanarWorldScan {
  ScanLine scan_line;
  std::vector<int> wall_of_beam;  // -1: a column or nothing
};

inline PlanarWorldScan TakePlanarWorldScan(const PlanarWorld& world,
                                           const Eigen::Vector2d& position,
                                           double heading,
                                           int num_beams,
                                           double field_of_view,
                                           double sweep_s = 0.0,
                                           const ScannerMotion& motion = {}) {
  PlanarWorldScan scan;
  ScanLine& line = scan.scan_line;
  line.angle_min = -0.5 * field_of_view;
  line.angle_increment = num_beams > 1 ? field_of_view / (num_beams - 1) : 0.0;
  line.time_increment_s = num_beams > 1 ? sweep_s / (num_beams - 1) : 0.0;
  for (int i = 0; i < num_beams; ++i) {
    // The twist is integrated in small steps from the middle time to the beam's.
    const double time = (i - 0.5 * (num_beams - 1)) * line.time_increment_s;
    constexpr int kSteps = 100;
    Eigen::Vector2d origin = position;
    for (int k = 0; k < kSteps; ++k) {
      const double angle = heading + motion.yaw_rate_rad_s * time * (k + 0.5) / kSteps;
      origin += Eigen::Rotation2Dd(angle) * motion.velocity_m_s * (time / kSteps);
    }
    const double angle = heading + motion.yaw_rate_rad_s * time + line.BeamAngle(i);
    int wall = -1;
    const double range = world.CastRay(origin, {std::cos(angle), std::sin(angle)}, &wall);
    line.ranges.push_back(static_cast<float>(range));
    scan.wall_of_beam.push_back(wall);
  }
  return scan;
}

inline ScanLine AddRangeNoise(const ScanLine& exact, double sigma, std::mt19937_64* random) {
  ScanLine noisy = exact;
  std::normal_distribution<double> noise(0.0, sigma);
  for (float& range : noisy.ranges) range = static_cast<float>(range + noise(*random));
  return noisy;
}

}  // namespace plumbline
