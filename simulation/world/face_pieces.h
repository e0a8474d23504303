#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "simulation/world/building.h"

namespace plumbline {

// Faces of one plane: a region in coordinates (u, v) along the plane.
struct PlaneOfFaces {
  Eigen::Vector3d normal;
  double distance = 0.0;
  Eigen::Vector3d u_axis;  // u_axis, v_axis, normal: right-handed
  Eigen::Vector3d v_axis;
  PlanarRegion region;

  Eigen::Vector3d ToWorld(const Eigen::Vector2d& uv) const {
    return uv.x() * u_axis + uv.y() * v_axis + distance * normal;
  }
  std::vector<Eigen::Vector3d> ToWorld(const Polygon2& loop) const;
};

// Adds a face for each connected piece of the region.
void AddFaces(const PlaneOfFaces& plane, PlaneType type, std::vector<Face>* faces);

// The upright quadrangle above a chord of an arc, whose free side is to the left of the way
// from a to b. Heights in metres.
struct ArcPiece {
  size_t circle = 0;  // position in a list of circles
  Eigen::Vector2d a;
  Eigen::Vector2d b;
  double bottom_a = 0.0;
  double bottom_b = 0.0;
  double top_a = 0.0;
  double top_b = 0.0;

  // True where the next piece begins at this one's end, at the same heights.
  bool IsContinuedBy(const ArcPiece& next) const;
};

// Returns the circle that an edge is a chord of, one that ReadFloorPlans has made.
std::optional<size_t> FindCircle(const Eigen::Vector2d& a,
                                 const Eigen::Vector2d& b,
                                 const std::vector<PlanCircle>& circles);

// Adds a cylinder's face for the pieces on one circle that follow each other in the list.
void AddArcFaces(const std::vector<ArcPiece>& pieces,
                 const std::vector<PlanCircle>& circles,
                 std::vector<Face>* faces);

// Throws the Error of walls that do not quite meet, at a place of the plan.
[[noreturn]] void FailOfShortEdge(const std::string& location, const Eigen::Vector2d& place);

}  // namespace plumbline
