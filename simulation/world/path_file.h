#pragma once

#include <Eigen/Core>
#include <set>
#include <string>
#include <vector>

namespace plumbline {

// PathFile is a path through a mesh, as planned beforehand.
struct PathFile {
  std::vector<Eigen::Vector3d> points;  // on the walking surface, frame of the mesh, m
  double smooth_m = 0.4;                // how far corners are rounded
  std::set<int> dropped;                // elements of the mesh that stand in the way: doors
};

// Reads a path file: lines "point x y z", "smooth r", "drop id ...", "building name", and
// comments that begin with #. Throws Error with file and line.
PathFile ReadPathFile(const std::string& path);

}  // namespace plumbline
