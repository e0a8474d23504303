#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace plumbline {

// TriangleMesh is a building as an architect's program gives it: surfaces without thickness,
// neither closed nor repaired. Metres, z up.
struct TriangleMesh {
  struct Triangle {
    std::array<int, 3> vertices = {0, 0, 0};  // positions in TriangleMesh::vertices
    int element = 0;                          // the building element that it belongs to
    bool glass = false;
  };
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Triangle> triangles;
};

// Reads a binary little-endian PLY file: vertices with float x, y, z; triangles as a list
// (uchar, int) named vertex_indices, then int element, uchar glass (docs/inputs.md). Throws
// Error naming the file when it is anything else or ends early.
TriangleMesh ReadTriangleMesh(const std::string& path);

}  // namespace plumbline
