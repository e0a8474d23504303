#pragma once

#include <Eigen/Core>
#include <cmath>

namespace plumbline {

// A vertical plane (a, d), n(a).x = d, in the coordinates (a, e) of a point on the floor plan,
// its anchor: e = d - n(a).anchor is the anchor's distance from it. Where a plane far from the
// origin turns about where it was seen, d changes with the turn's square and its derivative by
// a with the turn; e does neither.

inline Eigen::Vector2d AnchoredFromPlane(const Eigen::Vector2d& plane,
                                         const Eigen::Vector2d& anchor) {
  const Eigen::Vector2d normal(std::cos(plane[0]), std::sin(plane[0]));
  return {plane[0], plane[1] - normal.dot(anchor)};
}

// d (a, d) / d (a, e) at the angle a; its inverse is that of the opposite anchor.
inline Eigen::Matrix2d PlaneByAnchored(double a, const Eigen::Vector2d& anchor) {
  const Eigen::Vector2d along(-std::sin(a), std::cos(a));
  return (Eigen::Matrix2d() << 1.0, 0.0, along.dot(anchor), 1.0).finished();
}

}  // namespace plumbline
