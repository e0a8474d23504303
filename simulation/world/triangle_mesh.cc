#include "simulation/world/triangle_mesh.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>

#include "core/util/error.h"

namespace plumbline {
namespace {

constexpr size_t kMaxElements = 100000000;  // of a list; a larger number is a broken header

// Numbers of vertices and triangles, as the header states them.
struct Header {
  size_t num_vertices = 0;
  size_t num_triangles = 0;
};

// Reads the header's lines, and compares what they declare with the one layout that is read.
Header ReadHeader(std::istream& file, const std::string& path) {
  Header header;
  std::string layout;
  std::string line;
  for (int number = 1; std::getline(file, line) && line != "end_header"; ++number) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (number == 1 && line != "ply") throw Error(path + ": this is no PLY file");
    if (keyword == "comment" || keyword == "obj_info") continue;
    if (keyword == "element") {
      std::string name;
      size_t count = 0;
      words >> name >> count;
      if (!words || count > kMaxElements) throw Error(path + ": bad PLY header: " + line);
      (name == "vertex" ? header.num_vertices : header.num_triangles) = count;
      layout += "element " + name + ";";
    } else {
      layout += line + ";";
    }
  }
  if (layout !=
      "ply;format binary_little_endian 1.0;element vertex;property float x;property float y;"
      "property float z;element face;property list uchar int vertex_indices;"
      "property int element;property uchar glass;") {
    throw Error(path +
                ": the PLY file must be binary_little_endian, with vertices of float x, y, z "
                "and faces of list uchar int vertex_indices, int element, uchar glass");
  }
  return header;
}

template <typename T>
T Read(std::istream& file) {
  T value{};
  file.read(reinterpret_cast<char*>(&value), sizeof(value));
  return value;
}

}  // namespace

TriangleMesh ReadTriangleMesh(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path + ": can not open the file");
  const Header header = ReadHeader(file, path);
  TriangleMesh mesh;
  for (size_t i = 0; i < header.num_vertices && file; ++i) {
    Eigen::Vector3d& vertex = mesh.vertices.emplace_back();
    for (double& coordinate : vertex) coordinate = Read<float>(file);
    if (!vertex.allFinite()) throw Error(path + ": a vertex is no point");
  }
  for (size_t i = 0; i < header.num_triangles && file; ++i) {
    TriangleMesh::Triangle& triangle = mesh.triangles.emplace_back();
    if (Read<uint8_t>(file) != 3 && file) throw Error(path + ": a face is no triangle");
    for (int& vertex : triangle.vertices) {
      vertex = Read<int32_t>(file);
      if (vertex < 0 || static_cast<size_t>(vertex) >= header.num_vertices) {
        throw Error(path + ": a triangle has a vertex that does not exist");
      }
    }
    triangle.element = Read<int32_t>(file);
    triangle.glass = Read<uint8_t>(file) != 0;
  }
  if (!file) throw Error(path + ": the file breaks off");
  return mesh;
}

}  // namespace plumbline
