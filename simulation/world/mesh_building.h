#pragma once

#include <set>

#include "simulation/world/building.h"
#include "simulation/world/triangle_mesh.h"

namespace plumbline {

// Makes the faces of a mesh: connected triangles of one plane and one side, glass apart from
// the rest. dropped: elements that are left out, such as the doors on a path. Triangles
// without area are left out too.
Building MakeBuilding(const TriangleMesh& mesh, const std::set<int>& dropped);

}  // namespace plumbline
