#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

namespace plumbline {

using Polygon2 = std::vector<Eigen::Vector2d>;  // closed, first corner not repeated

// PolygonWithHoles is one connected piece of a region: its outer boundary runs
// counter-clockwise, its holes clockwise, so that the region is always to the left.
struct PolygonWithHoles {
  Polygon2 outer;
  std::vector<Polygon2> holes;
};

// True when the polygon has three corners or more and does not touch or cross itself.
bool IsSimplePolygon(const Polygon2& polygon);

// Whether a place lies in a polygon; on its boundary it may be either.
bool Contains(const Polygon2& polygon, const Eigen::Vector2d& place);

// PlanarRegion is a part of the plane with exact Boolean operations (CGAL).
class PlanarRegion {
 public:
  PlanarRegion();
  PlanarRegion(const PlanarRegion& other);
  PlanarRegion& operator=(const PlanarRegion& other);
  ~PlanarRegion();

  // The polygon has to be simple; its direction does not matter. One that is only a line adds
  // nothing.
  void Join(const Polygon2& polygon);
  void Join(const std::vector<Polygon2>& polygons);
  void Subtract(const Polygon2& polygon);
  void Subtract(const PlanarRegion& other);

  // Returns the connected pieces without redundant corners (collinear, or closer than a
  // micrometre), in an order that depends on the geometry only.
  std::vector<PolygonWithHoles> Polygons() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Divides a polygon into triangles, counter-clockwise.
std::vector<std::array<Eigen::Vector2d, 3>> Triangulate(const PolygonWithHoles& polygon);

}  // namespace plumbline
