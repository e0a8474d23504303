#pragma once

#include <Eigen/Core>

namespace plumbline {

// The measured plane seen from one pose: what the segment factors differentiate. Internal to
// them; templated so that Ceres' Jets pass through.

template <typename A, typename B>
auto Dot(const A& a, const B& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// a turned by the small rotation vector: a + tangent x a, exact in value and first derivative
// at tangent = 0.
template <typename T, typename A>
void TurnSlightly(const T tangent[3], const A& a, T turned[3]) {
  turned[0] = a[0] + tangent[1] * a[2] - tangent[2] * a[1];
  turned[1] = a[1] + tangent[2] * a[0] - tangent[0] * a[2];
  turned[2] = a[2] + tangent[0] * a[1] - tangent[1] * a[0];
}

// g of one node (SegmentMeasurement). x_axis, y_axis, origin: of the scanner, in the body
// frame (E: double or T). Turning the body by Exp(tangent) on the left is seen as turning the
// normal by -tangent.
template <typename T, typename E>
void NodeGeometry(const Eigen::Matrix3d& world_from_body,
                  const T opposite_tangent[3],
                  const T position[3],
                  const E x_axis[3],
                  const E y_axis[3],
                  const E origin[3],
                  const T normal[3],
                  const T& distance,
                  T g[3]) {
  T turned[3];
  TurnSlightly(opposite_tangent, normal, turned);
  E world[3];
  const E* const vectors_body[3] = {x_axis, y_axis, origin};
  for (int i = 0; i < 3; ++i) {
    for (int row = 0; row < 3; ++row) {
      world[row] = Dot(vectors_body[i], world_from_body.row(row));
    }
    g[i] = Dot(turned, world);
  }
  g[2] += Dot(normal, position) - distance;
}

}  // namespace plumbline
