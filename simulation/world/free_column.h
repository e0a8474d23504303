#pragma once

#include <Eigen/Core>
#include <vector>

namespace plumbline {

// A height over the plan that is linear in it: a level or sloped plane, z = at_origin +
// gradient . (x, y), metres.
struct HeightPlane {
  double at_origin = 0.0;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();  // m per m

  static HeightPlane Level(double height) { return {height, Eigen::Vector2d::Zero()}; }
  // Rises from one place to another, and is level across. The places must differ in plan.
  static HeightPlane Rising(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  double At(const Eigen::Vector2d& p) const { return at_origin + gradient.dot(p); }
  HeightPlane RaisedBy(double height) const { return {at_origin + height, gradient}; }
};

// Heights that are free above a place of the plan.
struct FreeInterval {
  HeightPlane bottom;
  HeightPlane top;
};

// All that is free above a place, from below; no interval touches the next.
using FreeColumn = std::vector<FreeInterval>;

// Frees, or fills, the heights between two planes above a place; nothing happens where the top
// is not above the bottom there. Heights that differ by less than kSamePlane are one.
void Free(const FreeInterval& interval, const Eigen::Vector2d& place, FreeColumn* column);
void Fill(const FreeInterval& interval, const Eigen::Vector2d& place, FreeColumn* column);

}  // namespace plumbline
