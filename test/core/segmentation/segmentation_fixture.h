#pragma once

#include <cmath>

#include "core/segmentation/segmentation.h"
#include "test/testing/planar_world.h"

namespace plumbline {

constexpr double kFieldOfView = 1.5 * M_PI;

// With the stated significance of 1e-4 per scan line and the tests of every segment's chi
// square a draw goes wrong with a probability below 1e-3: 5 of 500 has a probability below
// 2e-4.
constexpr int kMaxWrongDraws = 5;

struct Setting {
  int num_beams;
  double sigma;
};

inline Scanner MakeScanner(double sigma) {
  Scanner scanner;
  scanner.range_noise_m = sigma;
  scanner.angle_noise_rad = 0.0;
  return scanner;
}

inline double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// A wall in the scanner frame: through `point`, `normal` towards the scanner.
struct TrueLine {
  Eigen::Vector2d point;
  Eigen::Vector2d normal;
};

inline TrueLine LineOfWall(const PlanarWorld& world,
                           int wall,
                           const Eigen::Vector2d& position,
                           double heading) {
  const Eigen::Rotation2Dd scanner_from_world(-heading);
  const Eigen::Vector2d start =
      scanner_from_world * (world.walls[static_cast<size_t>(wall)].start - position);
  const Eigen::Vector2d end =
      scanner_from_world * (world.walls[static_cast<size_t>(wall)].end - position);
  const Eigen::Vector2d along = (end - start).normalized();
  Eigen::Vector2d normal(-along.y(), along.x());
  if (normal.dot(start) > 0.0) normal = -normal;
  return {start, normal};
}

// Errors of a segment's line in units of the standard deviations that it states.
struct WhitenedError {
  WhitenedError(const Segment& segment, const TrueLine& truth)
      : offset(truth.normal.dot(segment.centroid - truth.point) / segment.sigma_offset_m),
        direction(
            std::atan2(Cross(truth.normal, segment.normal), truth.normal.dot(segment.normal)) /
            segment.sigma_direction_rad) {}
  double offset;
  double direction;
};

inline PlanarWorld RectangularRoom() {
  return PlanarWorld().AddWalls({{-3, -2}, {5, -2}, {5, 3}, {-3, 3}, {-3, -2}});
}

}  // namespace plumbline
