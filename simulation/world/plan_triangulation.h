#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace plumbline {

// A straight line of the plan between two places.
struct PlanLine {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
};

struct PlanTriangle {
  std::array<Eigen::Vector2d, 3> corners;  // counter-clockwise
  // Position in the list of the triangle behind the edge from corner i to the next, or
  // kNoTriangle outside of all.
  std::array<int, 3> neighbours = {0, 0, 0};
};

inline constexpr int kNoTriangle = -1;

// Divides the convex hull of the segments into triangles that no segment crosses, with exact
// intersections. Corners are rounded to doubles afterwards, so that lines that coincide but
// for rounding leave triangles without area between them.
std::vector<PlanTriangle> TriangulatePlan(const std::vector<PlanLine>& segments);

}  // namespace plumbline
