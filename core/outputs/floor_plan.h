#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "core/outputs/map_cloud.h"
#include "core/outputs/storey_levels.h"
#include "core/result/plane_covariance.h"
#include "core/result/result_reader.h"
#include "core/result/result_types.h"
#include "core/sensor/rig.h"

namespace plumbline {

// All coordinates are x, y of the model frame, m.

// RoomEdge is a corner of a room and the edge to the next one. Edges go round the room with
// the room on their left.
struct RoomEdge {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  int plane_id = -1;      // the surface that the edge lies on; -1: of no surface
  double closed_m = 0.0;  // of its length, what was seen as wall, door or hidden piece of it
};

using RoomLoop = std::vector<RoomEdge>;

// Dimension is a clear distance between two opposite walls.
struct Dimension {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  int plane_a = -1;
  int plane_b = -1;
  double length_m = 0.0;
  double stddev_m = 0.0;
};

// RoomFloorOpening is where a room has no floor, such as over a stair to the storey below.
struct RoomFloorOpening {
  double area_m2 = 0.0;
  double stddev_m2 = 0.0;
  Eigen::AlignedBox2d box;
};

// Room is what walls enclose: its clear floor, without door openings, niches and openings in
// the floor.
struct Room {
  int number = 0;               // from 1 in the storey, in the order of the rig's visits
  std::vector<RoomLoop> loops;  // the outer one first; others are pillars and the like
  bool entered = false;         // the rig was in it; else it was only looked into
  std::vector<RoomFloorOpening> floor_openings;
  double area_m2 = 0.0;  // without these
  double area_stddev_m2 = 0.0;
  double perimeter_m = 0.0;  // of the outer loop
  double unseen_m = 0.0;     // of all its edges, what no wall, door or bridged piece shows
  std::optional<double> floor_m;  // heights of the model frame
  std::optional<double> ceiling_m;
  std::optional<double> height_stddev_m;  // of the ceiling above the floor
  std::vector<Dimension> dimensions;
  Eigen::Vector2d label = Eigen::Vector2d::Zero();  // well inside
};

// PlanDoor is a door in a wall.
struct PlanDoor {
  // Along the face towards rooms[0], and along the opposite face where that was seen.
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  // out of the wall at the first face
  double depth_m = 0.0;                               // of the wall; 0: not known
  double width_m = 0.0;
  double width_stddev_m = 0.0;
  bool has_lintel = false;     // the wall was seen above it
  bool reaches_floor = false;  // beams or the rig passed below where sills are
  bool leads_indoors = false;  // the rig went through, or beams, to a ceiling behind
  int plane_id = -1;
  int rooms[2] = {0, 0};  // numbers; 0: none that is known. One room: a way round leads there
};

// WallPiece is a stretch of a wall that was seen from both sides, as four corners.
struct WallPiece {
  std::vector<Eigen::Vector2d> corners;
  int plane_a = -1;
  int plane_b = -1;
  double thickness_m = 0.0;
  double stddev_m = 0.0;
};

// PlanWindow is a window: a stretch of a room's edge that beams passed above a parapet.
struct PlanWindow {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  // Standard deviation of the width: each jamb lies between the last beam that passed and the
  // next column beside it in which the wall was hit above sills.
  double width_stddev_m = 0.0;
  bool reaches_floor = false;  // beams passed below where sills are
};

struct StoreyPlan {
  StoreyLevel level;
  std::vector<Room> rooms;
  std::vector<PlanDoor> doors;
  std::vector<WallPiece> walls;
  std::vector<PlanWindow> windows;
  // Outlines of what is solid: between rooms, and within them.
  std::vector<std::vector<Eigen::Vector2d>> solids;
};

struct FloorPlans {
  std::vector<StoreyPlan> storeys;  // from the lowest up
  MapOrigin origin;                 // of the map
};

// The input of a floor plan.
struct FloorPlanInput {
  PlaneCovariance planes;
  std::vector<StampedPose> poses;
  std::vector<CloudPoint> points;
  int64_t start_ns = 0;  // the instant from which the points' times count
  MapOrigin origin;
  Rig rig;
};

// Reads summary.json, planes.json, plane_covariance.csv, trajectory.tum and map.ply of a
// result, and the rig file; where that is empty, the one that the result holds. Throws Error.
FloorPlanInput ReadFloorPlanInput(const std::string& result_directory,
                                  const std::string& rig_file);

// Makes the plan. Throws Error where there is nothing to make it of.
FloorPlans MakeFloorPlan(const FloorPlanInput& input);

}  // namespace plumbline
