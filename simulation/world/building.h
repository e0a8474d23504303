#pragma once

#include <Eigen/Core>
#include <array>
#include <set>
#include <string>
#include <vector>

#include "core/result/result_types.h"
#include "simulation/world/floor_plan.h"

namespace plumbline {

// Planes whose normals (unit vectors) and distances (m) differ by less are one: far above what
// rounding leaves, far below what a building file tells apart.
inline constexpr double kSamePlane = 1e-6;
// m; shorter edges of faces are a mistake in the file.
inline constexpr double kMinEdge = 1e-3;

// A face is a connected piece of a plane that borders free space, or an upright cylinder's:
// what the mapper should find.
struct Face {
  int id = 0;  // position in Building::faces
  PlaneType type = PlaneType::kVertical;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // into the free space
  double distance = 0.0;                              // normal . p = distance
  // Curvature of a cylinder: 1/m, negative where its axis lies in the free space. Its normal
  // and distance are those in its middle, its triangles facets.
  double curvature = 0.0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // of a cylinder, on it
  // Closed polygons on the plane; counter-clockwise, holes clockwise, seen from free space.
  // Pieces of a mesh that touch the outline in a vertex stand with the holes.
  std::vector<Eigen::Vector3d> outline;
  std::vector<std::vector<Eigen::Vector3d>> holes;
  std::vector<std::array<Eigen::Vector3d, 3>> triangles;  // cover the face, counter-clockwise
  bool glass = false;                                     // a beam may go through

  double Area() const;
  Eigen::Vector3d Centroid() const;
  // The outline, and the pieces that touch it, reached by bridges: by the even-odd rule, a
  // point is inside if it is in any of them.
  std::vector<Eigen::Vector3d> OutlineOfPieces() const;
};

// Building holds the faces of storeys, floors, ceilings, walls, lintels, or those of a mesh.
struct Building {
  // Every point is either in the free space or not. Meshes have gaps, and leave that open.
  bool is_closed = true;
  double floor_height = 0.0;    // of the lowest storey
  double ceiling_height = 0.0;  // of the highest
  std::vector<Face> faces;
};

// Builds the free space of a level storey (FloorPlan::IsLevel) layer by layer between the tops
// of openings, with exact Boolean operations, so that nothing remains hidden where walls meet
// or overlap. Coplanar pieces that touch and face the same side are one face. Throws Error
// naming the place when walls leave a face of less than a millimetre.
Building MakeBuilding(const FloorPlan& plan);

// Reads a building file, a floor plan (YAML) or a triangle mesh (.ply), and builds its faces.
// dropped: elements of the mesh that are left out. Throws Error with file and line.
Building ReadBuilding(const std::string& path, const std::set<int>& dropped = {});

}  // namespace plumbline
