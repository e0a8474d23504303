#include "simulation/world/mesh_building.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>

#include "core/geometry/angles.h"

namespace plumbline {
namespace {

constexpr double kSameVertex = 1e-4;  // m; single precision leaves 1e-6
constexpr double kFlatness = 1e-3;    // m; of the vertices of one face from its plane
constexpr double kMinArea = 1e-8;     // m^2; smaller triangles have no sure normal
// Tolerance of the normals of one face's triangles, and of a plane from the vertical or
// horizontal.
const double kSameDirection = 0.1 * kRadiansPerDegree;

// A triangle whose vertices are shared with its neighbours.
struct WeldedTriangle {
  std::array<int, 3> vertices;
  Eigen::Vector3d normal;
  double area = 0.0;
  bool glass = false;
};

// FaceGrower collects triangles of one plane, the largest first: its plane is the face's.
class FaceGrower {
 public:
  FaceGrower(const TriangleMesh& mesh, const std::set<int>& dropped) {
    Weld(mesh);
    for (const TriangleMesh::Triangle& triangle : mesh.triangles) {
      if (dropped.count(triangle.element) == 0) AddTriangle(triangle);
    }
    triangles_at_.resize(vertices_.size());
    for (size_t i = 0; i < triangles_.size(); ++i) {
      for (const int vertex : triangles_[i].vertices) At(vertex).push_back(i);
    }
    taken_.assign(triangles_.size(), false);
  }

  std::vector<Face> Grow() {
    std::vector<size_t> order(triangles_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [this](size_t a, size_t b) {
      return triangles_[a].area > triangles_[b].area;
    });
    std::vector<Face> faces;
    for (const size_t seed : order) {
      if (taken_[seed]) continue;
      faces.push_back(MakeFace(Connected(seed)));
      faces.back().id = static_cast<int>(faces.size()) - 1;
    }
    return faces;
  }

 private:
  void Weld(const TriangleMesh& mesh) {
    std::map<std::array<int64_t, 3>, int> known;
    for (const Eigen::Vector3d& p : mesh.vertices) {
      std::array<int64_t, 3> cell;
      for (int axis = 0; axis < 3; ++axis) {
        cell[static_cast<size_t>(axis)] = std::llround(p[axis] / kSameVertex);
      }
      const auto [entry, is_new] = known.insert({cell, static_cast<int>(vertices_.size())});
      if (is_new) vertices_.push_back(p);
      welded_.push_back(entry->second);
    }
  }

  void AddTriangle(const TriangleMesh::Triangle& triangle) {
    WeldedTriangle welded;
    for (size_t i = 0; i < 3; ++i) {
      welded.vertices[i] = welded_[static_cast<size_t>(triangle.vertices[i])];
    }
    const Eigen::Vector3d& a = Vertex(welded.vertices[0]);
    const Eigen::Vector3d cross =
        (Vertex(welded.vertices[1]) - a).cross(Vertex(welded.vertices[2]) - a);
    welded.area = cross.norm() / 2;
    if (welded.area < kMinArea) return;
    welded.normal = cross.normalized();
    welded.glass = triangle.glass;
    triangles_.push_back(welded);
  }

  // The triangles that lie on the seed's plane and hang together with it.
  std::vector<size_t> Connected(size_t seed) {
    const Eigen::Vector3d normal = triangles_[seed].normal;
    const double distance = normal.dot(Vertex(triangles_[seed].vertices[0]));
    const auto fits = [&](const WeldedTriangle& triangle) {
      if (triangle.glass != triangles_[seed].glass) return false;
      if (triangle.normal.dot(normal) < std::cos(kSameDirection)) return false;
      return std::all_of(triangle.vertices.begin(), triangle.vertices.end(), [&](int vertex) {
        return std::abs(normal.dot(Vertex(vertex)) - distance) < kFlatness;
      });
    };
    std::vector<size_t> members = {seed};
    taken_[seed] = true;
    for (size_t next = 0; next < members.size(); ++next) {
      const std::array<int, 3> vertices = triangles_[members[next]].vertices;
      for (const int vertex : vertices) {
        for (const size_t neighbour : At(vertex)) {
          if (taken_[neighbour] || !fits(triangles_[neighbour])) continue;
          taken_[neighbour] = true;
          members.push_back(neighbour);
        }
      }
    }
    return members;
  }

  Face MakeFace(const std::vector<size_t>& members) const {
    Face face;
    double area = 0.0;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const size_t index : members) {
      const WeldedTriangle& triangle = triangles_[index];
      std::array<Eigen::Vector3d, 3>& corners = face.triangles.emplace_back();
      for (size_t i = 0; i < 3; ++i) corners[i] = Vertex(triangle.vertices[i]);
      area += triangle.area;
      normal += triangle.area * triangle.normal;
      centre += triangle.area * (corners[0] + corners[1] + corners[2]) / 3;
    }
    face.normal = normal.normalized();
    face.distance = face.normal.dot(centre) / area;
    face.glass = triangles_[members.front()].glass;
    const double up = std::abs(face.normal.z());
    face.type = up > std::cos(kSameDirection)   ? PlaneType::kHorizontal
                : up < std::sin(kSameDirection) ? PlaneType::kVertical
                                                : PlaneType::kGeneral;
    TraceOutline(members, &face);
    return face;
  }

  // Follows the edges that belong to one triangle only. The longest way round is the outline,
  // the others are holes, or pieces that touch the first in a vertex.
  void TraceOutline(const std::vector<size_t>& members, Face* face) const {
    std::map<std::pair<int, int>, int> edges;  // with how often they run so
    for (const size_t index : members) {
      const std::array<int, 3>& v = triangles_[index].vertices;
      for (size_t i = 0; i < 3; ++i) {
        const std::pair<int, int> edge = {v[i], v[(i + 1) % 3]};
        const auto reverse = edges.find({edge.second, edge.first});
        if (reverse == edges.end()) {
          ++edges[edge];
        } else if (--reverse->second == 0) {
          edges.erase(reverse);
        }
      }
    }
    double longest = 0.0;
    while (!edges.empty()) {
      std::vector<Eigen::Vector3d> loop;
      double length = 0.0;
      for (auto edge = edges.begin(); edge != edges.end();) {
        const auto [from, to] = edge->first;
        loop.push_back(Vertex(from));
        length += (Vertex(to) - Vertex(from)).norm();
        if (--edge->second == 0) edges.erase(edge);
        edge = edges.lower_bound({to, 0});
        if (edge != edges.end() && edge->first.first != to) break;
      }
      if (length > longest) {
        longest = length;
        std::swap(loop, face->outline);
      }
      if (loop.size() >= 3) face->holes.push_back(std::move(loop));
    }
  }

  const Eigen::Vector3d& Vertex(int index) const {
    return vertices_[static_cast<size_t>(index)];
  }
  std::vector<size_t>& At(int vertex) { return triangles_at_[static_cast<size_t>(vertex)]; }

  std::vector<Eigen::Vector3d> vertices_;  // each once
  std::vector<int> welded_;                // position in vertices_ of each vertex of the mesh
  std::vector<WeldedTriangle> triangles_;
  std::vector<std::vector<size_t>> triangles_at_;  // of each vertex
  std::vector<bool> taken_;
};

}  // namespace

Building MakeBuilding(const TriangleMesh& mesh, const std::set<int>& dropped) {
  Building building;
  building.is_closed = false;
  building.faces = FaceGrower(mesh, dropped).Grow();
  return building;
}

}  // namespace plumbline
