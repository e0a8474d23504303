#include "simulation/world/mesh_building.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "simulation/world/ray_caster.h"
#include "simulation/world/triangle_mesh.h"
#include "test/testing/test_files.h"

namespace plumbline {
namespace {

// A box of 4 x 3 x 2 m, seen from outside, whose triangles do not share vertices. A side is
// halved at its middle, and the triangles of element 7 are the box's top.
TriangleMesh Box() {
  TriangleMesh mesh;
  const Eigen::Vector3d size(4, 3, 2);
  const auto add = [&](const std::array<Eigen::Vector3d, 3>& corners, int element) {
    const int first = static_cast<int>(mesh.vertices.size());
    for (const Eigen::Vector3d& corner : corners) mesh.vertices.push_back(corner);
    mesh.triangles.push_back({{first, first + 1, first + 2}, element, false});
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool far : {false, true}) {
      const int u = (axis + (far ? 1 : 2)) % 3;
      const int v = (axis + (far ? 2 : 1)) % 3;
      const auto corner = [&](bool at_u, bool at_v) {
        Eigen::Vector3d p = Eigen::Vector3d::Zero();
        p[axis] = far ? size[axis] : 0.0;
        p[u] = at_u ? size[u] : 0.0;
        p[v] = at_v ? size[v] : 0.0;
        return p;
      };
      const int element = axis == 2 && far ? 7 : 1;
      add({corner(false, false), corner(true, false), corner(true, true)}, element);
      add({corner(false, false), corner(true, true), corner(false, true)}, element);
    }
  }
  return mesh;
}

TEST(MeshBuilding, BoxHasSixFacesWithOutlines) {
  const Building building = MakeBuilding(Box(), {});
  EXPECT_FALSE(building.is_closed);
  ASSERT_EQ(building.faces.size(), 6u);
  int num_horizontal = 0;
  for (const Face& face : building.faces) {
    EXPECT_EQ(face.id, &face - building.faces.data());
    EXPECT_EQ(face.triangles.size(), 2u);
    EXPECT_EQ(face.outline.size(), 4u);
    EXPECT_TRUE(face.holes.empty());
    num_horizontal += face.type == PlaneType::kHorizontal;
    // Out of the box.
    EXPECT_GT(face.normal.dot(face.Centroid() - Eigen::Vector3d(2, 1.5, 1)), 0.9);
    for (const Eigen::Vector3d& corner : face.outline) {
      EXPECT_NEAR(face.normal.dot(corner), face.distance, 1e-12);
    }
  }
  EXPECT_EQ(num_horizontal, 2);
  EXPECT_NEAR(building.faces.front().Area(), 12.0, 1e-12);  // the largest first
}

TEST(MeshBuilding, DroppedElementsAndSliversAreLeftOut) {
  TriangleMesh mesh = Box();
  mesh.vertices.insert(mesh.vertices.end(), {{9, 9, 9}, {9, 9, 9.00001}, {9, 9, 9.00002}});
  const int sliver = static_cast<int>(mesh.vertices.size()) - 3;
  mesh.triangles.push_back({{sliver, sliver + 1, sliver + 2}, 1, false});
  const Building building = MakeBuilding(mesh, {7});
  ASSERT_EQ(building.faces.size(), 5u);
  for (const Face& face : building.faces) EXPECT_LT(face.normal.z(), 0.5);
}

TEST(MeshBuilding, GlassAndOtherSidesAreFacesOfTheirOwn) {
  TriangleMesh mesh = Box();
  mesh.triangles[0].glass = true;
  EXPECT_EQ(MakeBuilding(mesh, {}).faces.size(), 7u);
  mesh = Box();
  std::swap(mesh.triangles[0].vertices[0], mesh.triangles[0].vertices[1]);
  EXPECT_EQ(MakeBuilding(mesh, {}).faces.size(), 7u);
}

TEST(MeshBuilding, FrameHasAHole) {
  // A square ring in the plane z = 1, of eight triangles.
  TriangleMesh mesh;
  for (const double half : {2.0, 1.0}) {
    for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
      mesh.vertices.emplace_back(half * x, half * y, 1.0);
    }
  }
  for (int i = 0; i < 4; ++i) {
    const int next = (i + 1) % 4;
    mesh.triangles.push_back({{i, next, 4 + next}, 0, false});
    mesh.triangles.push_back({{i, 4 + next, 4 + i}, 0, false});
  }
  const Building building = MakeBuilding(mesh, {});
  ASSERT_EQ(building.faces.size(), 1u);
  EXPECT_NEAR(building.faces[0].Area(), 12.0, 1e-12);
  ASSERT_EQ(building.faces[0].outline.size(), 4u);
  for (const Eigen::Vector3d& corner : building.faces[0].outline) {
    EXPECT_NEAR(std::abs(corner.x()), 2.0, 1e-12);
  }
  ASSERT_EQ(building.faces[0].holes.size(), 1u);
  EXPECT_EQ(building.faces[0].holes[0].size(), 4u);
}

TEST(MeshBuilding, PiecesThatTouchInAVertexHaveOneOutline) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {6, 3, 0}, {6, 4, 0}};
  mesh.triangles.push_back({{0, 1, 2}, 1, false});
  mesh.triangles.push_back({{2, 3, 4}, 1, false});
  const Building building = MakeBuilding(mesh, {});
  ASSERT_EQ(building.faces.size(), 1u);
  const std::vector<Eigen::Vector3d> outline = building.faces[0].OutlineOfPieces();
  double twice_area = 0.0;
  for (size_t i = 0; i < outline.size(); ++i) {
    twice_area += outline[i].cross(outline[(i + 1) % outline.size()]).z();
  }
  EXPECT_NEAR(twice_area / 2, 7.0, 1e-12) << "both pieces, and bridges without an area";
}

TEST(MeshBuilding, BeamsPassGlassOnRequest) {
  TriangleMesh mesh = Box();
  for (TriangleMesh::Triangle& triangle : mesh.triangles)
    triangle.glass = triangle.element == 7;
  const Building building = MakeBuilding(mesh, {});
  const RayCaster caster(building);
  const Eigen::Vector3d from_above(2, 1.4, 5);
  const std::optional<RayHit> pane = caster.Cast(from_above, -Eigen::Vector3d::UnitZ());
  ASSERT_TRUE(pane);
  EXPECT_NEAR(pane->range, 3.0, 1e-12);
  EXPECT_TRUE(pane->is_glass);
  EXPECT_FALSE(pane->from_behind);
  const std::optional<RayHit> floor = caster.Cast(from_above, -Eigen::Vector3d::UnitZ(), true);
  ASSERT_TRUE(floor);
  EXPECT_NEAR(floor->range, 5.0, 1e-12);
  EXPECT_FALSE(floor->is_glass);
  EXPECT_TRUE(floor->from_behind);  // the box's bottom, from inside
}

// Bytes of a PLY file with one triangle.
std::string Ply(const std::string& layout) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\ncomment m\nelement vertex 3\n"
      "property float x\nproperty float y\nproperty float z\n" +
      layout + "end_header\n";
  const auto append = [&text](const auto& value) {
    char bytes[sizeof(value)];
    std::memcpy(bytes, &value, sizeof(value));
    text.append(bytes, sizeof(value));
  };
  for (const float coordinate : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 2.f, 0.5f}) {
    append(coordinate);
  }
  append(uint8_t{3});
  for (const int32_t index : {0, 1, 2}) append(index);
  append(int32_t{42});
  append(uint8_t{1});
  return text;
}

constexpr char kFaces[] =
    "element face 1\nproperty list uchar int vertex_indices\n"
    "property int element\nproperty uchar glass\n";

TEST(TriangleMesh, ReadsWhatTheFileHolds) {
  const TriangleMesh mesh = ReadTriangleMesh(WriteTestFile("one.ply", Ply(kFaces)));
  ASSERT_EQ(mesh.vertices.size(), 3u);
  EXPECT_EQ(mesh.vertices[2], Eigen::Vector3d(0, 2, 0.5));
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.triangles[0].vertices, (std::array<int, 3>{0, 1, 2}));
  EXPECT_EQ(mesh.triangles[0].element, 42);
  EXPECT_TRUE(mesh.triangles[0].glass);
}

TEST(TriangleMesh, ErrorsNameTheFile) {
  const auto error = [](const std::string& text) {
    const std::string path = WriteTestFile("bad.ply", text);
    const std::string message = ErrorOf([&] { ReadTriangleMesh(path); });
    return message.rfind(path + ": ", 0) == 0 ? message.substr(path.size() + 2) : message;
  };
  const std::string whole = Ply(kFaces);
  EXPECT_EQ(error(whole.substr(0, whole.size() - 1)), "the file breaks off");
  EXPECT_EQ(error("solid box\n"), "this is no PLY file");
  EXPECT_EQ(
      error(Ply("element face 1\n")).rfind("the PLY file must be binary_little_endian", 0),
      0u);
  std::string wrong_vertex = whole;
  wrong_vertex[whole.size() - 9] = 3;  // the last vertex index
  EXPECT_EQ(error(wrong_vertex), "a triangle has a vertex that does not exist");
  std::string square = whole;
  square[whole.size() - 18] = 4;  // vertices of the face
  EXPECT_EQ(error(square), "a face is no triangle");
  EXPECT_EQ(ErrorOf([] { ReadTriangleMesh("no/such.ply"); }),
            "no/such.ply: can not open the file");
}

}  // namespace
}  // namespace plumbline
