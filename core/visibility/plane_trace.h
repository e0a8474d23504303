#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <optional>

#include "core/geometry/scan_plane_motion.h"
#include "core/surface/landmark.h"
#include "core/surface/landmark_view.h"

namespace plumbline {

// The trace of a plane in the scan plane: normal . p = distance. The normal's length is the
// sine of the angle between the planes.
struct Trace {
  Eigen::Vector2d normal;
  double distance;

  Trace(const ScanPlacement& placement, const LandmarkView& plane)
      : normal(placement.col(0).dot(plane.normal), placement.col(1).dot(plane.normal)),
        distance(plane.distance - placement.col(2).dot(plane.normal)) {}

  // The range of a beam on the plane; infinite where the beam does not meet it.
  double RangeAlong(const Eigen::Vector2d& direction) const {
    const double range = distance / normal.dot(direction);
    return range > 0.0 ? range : std::numeric_limits<double>::infinity();
  }
};

// The point where two traces cross; nothing where they are nearly parallel.
inline std::optional<Eigen::Vector2d> Crossing(const Trace& a, const Trace& b) {
  constexpr double kMinSine = 0.02;  // below it noise moves the point by decimetres
  const double sine = a.normal.x() * b.normal.y() - a.normal.y() * b.normal.x();
  if (std::abs(sine) < kMinSine) return std::nullopt;
  return Eigen::Vector2d(a.distance * b.normal.y() - b.distance * a.normal.y(),
                         b.distance * a.normal.x() - a.distance * b.normal.x()) /
         sine;
}

}  // namespace plumbline
