#pragma once

#include <string>
#include <vector>

#include "simulation/world/free_column.h"
#include "simulation/world/furniture.h"
#include "simulation/world/planar_region.h"

namespace plumbline {

// An opening is a door or passage through the wall's whole thickness, from the floor up.
struct Opening {
  double position_m = 0.0;  // of its middle, along the wall
  double width_m = 0.0;
  double height_m = 0.0;  // above the floor; up to the ceiling there is no lintel
};

// Returns the rectangle between two positions along a straight way, seen from above; half of
// its width lies to either side.
Polygon2 RectangleAlong(const Eigen::Vector2d& from,
                        const Eigen::Vector2d& to,
                        double width_m,
                        double begin_m,
                        double end_m);

// A straight wall can be seen from both sides; from and to are the ends of its centre line.
struct Wall {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  double thickness_m = 0.0;
  std::vector<Opening> openings;

  // Returns the outline of the wall between two positions along it, seen from above.
  Polygon2 Footprint(double begin_m, double end_m) const;
  // Returns the outlines of what stands beside some of its openings.
  std::vector<Polygon2> FootprintsBeside(std::vector<Opening> open) const;
};

// A circle that arcs of polygons lie on.
struct PlanCircle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius_m = 0.0;
};

// An outline whose floor or ceiling has a height of its own.
struct Hall {
  Polygon2 corners;
  double floor_height = 0.0;
  double ceiling_height = 0.0;
};

// A ramp has a floor that slopes. Above its corners it takes the place of all outlines.
struct Ramp {
  Polygon2 corners;
  HeightPlane floor;
  HeightPlane ceiling;
};

// A straight flight of stairs: its steps have equal treads and risers, the last tread is the
// landing's height.
struct Stairs {
  std::string location;  // "file:line", for messages
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  // middle of the lowest riser's foot
  Eigen::Vector3d to = Eigen::Vector3d::Zero();    // middle of the last tread's far edge
  double width_m = 0.0;
  int num_steps = 0;
  // Of the flight below the line of its edges, m; 0: the steps are solid down to the foot.
  double thickness_m = 0.0;
};

// A roof is a plane that rises from its eave, or two that fall from their ridge.
struct Roof {
  std::string location;  // "file:line", for messages
  std::vector<HeightPlane> planes;
};

// An opening in a storey's floor, through the slab to the storey below.
struct FloorOpening {
  std::string location;  // "file:line", for messages
  Polygon2 corners;
};

// FloorPlan is one storey as a building file describes it. Heights and positions are metres in
// the building's frame, which is the world of the simulation.
struct FloorPlan {
  std::string location;  // "file:line", for messages
  double floor_height = 0.0;
  double ceiling_height = 0.0;
  std::vector<Polygon2> outlines;  // seen from inside; together they are what is not outdoors
  std::vector<Hall> halls;         // outlines too
  std::vector<Ramp> ramps;
  std::vector<Roof> roofs;  // the storey ends below each of their planes
  std::vector<Stairs> stairs;
  std::vector<FloorOpening> floor_openings;
  std::vector<Polygon2> solids;     // blocks and pillars, seen from outside
  std::vector<PlanCircle> circles;  // of the polygons' arcs, which are corners close together
  std::vector<Wall> walls;
  std::vector<Furniture> furniture;

  // Whether there is one floor and one ceiling, both level: neither halls, ramps, roof, stairs
  // nor floor openings.
  bool IsLevel() const;
};

// Reads the storeys of a building file (docs/inputs.md), from the lowest up. Throws Error with
// file and line, also for outlines that cross themselves, for openings that do not fit
// their wall, and for ramps, solids, walls and furniture that touch no room of their storey.
std::vector<FloorPlan> ReadFloorPlans(const std::string& path);

}  // namespace plumbline
