#pragma once

#include <string>
#include <vector>

#include "simulation/world/furniture.h"
#include "simulation/world/planar_region.h"

namespace plumbline {

// An opening is a door or passage through the wall's whole thickness, from the floor up.
struct Opening {
  double position_m = 0.0;  // of its middle, along the wall
  double width_m = 0.0;
  double height_m = 0.0;  // above the floor; up to the ceiling there is no lintel
};

// A straight wall can be seen from both sides; from and to are the ends of its centre line.
struct Wall {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  double thickness_m = 0.0;
  std::vector<Opening> openings;

  // Returns the outline of the wall between two positions along it, seen from above.
  Polygon2 Footprint(double begin_m, double end_m) const;
};

// A circle that arcs of polygons lie on.
struct PlanCircle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
};

// FloorPlan is one storey as a building file describes it. Heights and positions are metres in
// the building's frame, which is the world of the simulation.
struct FloorPlan {
  std::string location;  // "file:line", for messages
  double floor_height = 0.0;
  double ceiling_height = 0.0;
  std::vector<Polygon2> outlines;   // seen from inside; together they are what is not outdoors
  std::vector<Polygon2> solids;     // blocks and pillars, seen from outside
  std::vector<PlanCircle> circles;  // of the polygons' arcs, which are corners close together
  std::vector<Wall> walls;
  std::vector<Furniture> furniture;
};

// Reads a building file (docs/inputs.md). Throws Error with file and line, also for outlines
// that cross themselves and for openings that do not fit their wall.
FloorPlan ReadFloorPlan(const std::string& path);

}  // namespace plumbline
