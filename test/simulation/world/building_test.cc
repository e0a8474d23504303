#include "simulation/world/building.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "test/testing/test_files.h"

namespace plumbline {
namespace {

const Polygon2 kSquare = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};

FloorPlan SquarePlan() {
  FloorPlan plan;
  plan.location = "plan.yaml:1";
  plan.ceiling_height = 3.0;
  plan.outlines = {kSquare};
  return plan;
}

Wall MakeWall(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double thickness) {
  Wall wall;
  wall.from = from;
  wall.to = to;
  wall.thickness_m = thickness;
  return wall;
}

// Faces with this normal and distance.
std::vector<Face> FacesOn(const Building& building,
                          const Eigen::Vector3d& normal,
                          double distance) {
  std::vector<Face> faces;
  for (const Face& face : building.faces) {
    if ((face.normal - normal).norm() < 1e-9 && std::abs(face.distance - distance) < 1e-9) {
      faces.push_back(face);
    }
  }
  return faces;
}

double TotalArea(const std::vector<Face>& faces) {
  double area = 0.0;
  for (const Face& face : faces) area += face.Area();
  return area;
}

TEST(Building, SquareRoomHasSixFaces) {
  const Building building = MakeBuilding(SquarePlan());
  ASSERT_EQ(building.faces.size(), 6u);
  EXPECT_NEAR(TotalArea(FacesOn(building, {0, 0, 1}, 0.0)), 16.0, 1e-12);
  EXPECT_NEAR(TotalArea(FacesOn(building, {0, 0, -1}, -3.0)), 16.0, 1e-12);
  EXPECT_NEAR(TotalArea(FacesOn(building, {1, 0, 0}, 0.0)), 12.0, 1e-12);
  EXPECT_NEAR(TotalArea(FacesOn(building, {-1, 0, 0}, -4.0)), 12.0, 1e-12);
  EXPECT_NEAR(TotalArea(FacesOn(building, {0, 1, 0}, 0.0)), 12.0, 1e-12);
  EXPECT_NEAR(TotalArea(FacesOn(building, {0, -1, 0}, -4.0)), 12.0, 1e-12);
  for (size_t i = 0; i < building.faces.size(); ++i) {
    EXPECT_EQ(building.faces[i].id, static_cast<int>(i));
  }
}

TEST(Building, OutlinesTurnAboutTheNormal) {
  FloorPlan plan = SquarePlan();
  plan.solids = {{{1, 1}, {2, 1}, {2, 2}}};
  for (const Face& face : MakeBuilding(plan).faces) {
    Eigen::Vector3d doubled_area = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < face.outline.size(); ++i) {
      const Eigen::Vector3d& corner = face.outline[i];
      EXPECT_NEAR(face.normal.dot(corner), face.distance, 1e-12);
      doubled_area += corner.cross(face.outline[(i + 1) % face.outline.size()]);
    }
    EXPECT_GT(face.normal.dot(doubled_area), 0.0) << "face " << face.id;
  }
}

TEST(Building, PillarLeavesAHole) {
  FloorPlan plan = SquarePlan();
  plan.solids = {{{1, 1}, {2, 1}, {2, 2}, {1, 2}}};
  const Building building = MakeBuilding(plan);
  EXPECT_EQ(building.faces.size(), 10u);
  const std::vector<Face> floor = FacesOn(building, {0, 0, 1}, 0.0);
  ASSERT_EQ(floor.size(), 1u);
  EXPECT_EQ(floor[0].holes.size(), 1u);
  EXPECT_NEAR(floor[0].Area(), 15.0, 1e-12);
  EXPECT_NEAR(TotalArea(FacesOn(building, {-1, 0, 0}, 1.0 * -1)), 3.0, 1e-12);
}

// A wall across the room with a door: the lintel joins the pieces beside the door, and nothing
// of the wall's ends remains where it meets the outline.
TEST(Building, DoorInAWall) {
  FloorPlan plan = SquarePlan();
  Wall wall = MakeWall({2, -0.1}, {2, 4.1}, 0.2);
  wall.openings = {{1.1, 1.0, 2.0}};  // from y = 0.5 to 1.5
  plan.walls = {wall};
  const Building building = MakeBuilding(plan);
  for (const auto& [normal, distance] :
       {std::pair(Eigen::Vector3d(-1, 0, 0), -1.9), {Eigen::Vector3d(1, 0, 0), 2.1}}) {
    const std::vector<Face> side = FacesOn(building, normal, distance);
    ASSERT_EQ(side.size(), 1u);
    EXPECT_NEAR(side[0].Area(), 4.0 * 3.0 - 1.0 * 2.0, 1e-9);
    EXPECT_EQ(side[0].outline.size(), 8u);
  }
  EXPECT_NEAR(TotalArea(FacesOn(building, {0, 1, 0}, 0.5)), 0.2 * 2.0, 1e-9);
  EXPECT_NEAR(TotalArea(FacesOn(building, {0, -1, 0}, -1.5)), 0.2 * 2.0, 1e-9);
  EXPECT_NEAR(TotalArea(FacesOn(building, {0, 0, -1}, -2.0)), 0.2 * 1.0, 1e-9);
  EXPECT_EQ(FacesOn(building, {0, 0, 1}, 0.0).size(), 1u);    // one floor through the door
  EXPECT_EQ(FacesOn(building, {0, 0, -1}, -3.0).size(), 2u);  // a ceiling per room
  // Floor, 2 ceilings, 2 x 3 outer walls, 2 sides, 2 reveals, 1 lintel.
  EXPECT_EQ(building.faces.size(), 1u + 2u + 6u + 2u + 2u + 1u);
}

TEST(Building, OpeningUpToTheCeilingHasNoLintel) {
  FloorPlan plan = SquarePlan();
  Wall wall = MakeWall({2, 0}, {2, 4}, 0.2);
  wall.openings = {{2.0, 1.0, 3.0}};
  plan.walls = {wall};
  const Building building = MakeBuilding(plan);
  EXPECT_EQ(FacesOn(building, {0, 0, -1}, -3.0).size(), 1u);
  EXPECT_EQ(FacesOn(building, {-1, 0, 0}, -1.9).size(), 2u);
}

TEST(Building, NothingIsHiddenWhereWallsOverlap) {
  FloorPlan plan = SquarePlan();
  plan.walls = {MakeWall({1, 2}, {3, 2}, 0.2), MakeWall({2, 1}, {2, 3}, 0.1)};
  const Building building = MakeBuilding(plan);
  // A cross has twelve sides.
  EXPECT_EQ(building.faces.size(), 6u + 12u);
  EXPECT_NEAR(TotalArea(FacesOn(building, {0, 1, 0}, 2.1)), 3.0 * (2.0 - 0.1), 1e-9);
  EXPECT_EQ(FacesOn(building, {0, 1, 0}, 2.1).size(), 2u);
}

TEST(Building, SlantedWallsMeetCleanly) {
  FloorPlan plan = SquarePlan();
  const Eigen::Rotation2Dd turn(0.3);
  for (Eigen::Vector2d& corner : plan.outlines[0]) corner = turn * corner;
  // One long wall in two pieces that overlap, and one that ends inside it.
  plan.walls = {MakeWall(turn * Eigen::Vector2d(-0.1, 2), turn * Eigen::Vector2d(2.3, 2), 0.1),
                MakeWall(turn * Eigen::Vector2d(2.2, 2), turn * Eigen::Vector2d(4.1, 2), 0.1),
                MakeWall(turn * Eigen::Vector2d(2, 2), turn * Eigen::Vector2d(2, 4.1), 0.1)};
  const Building building = MakeBuilding(plan);
  // Three rooms with floor, ceiling and four walls each.
  EXPECT_EQ(building.faces.size(), 18u);
}

TEST(Building, NearMissesAreErrors) {
  FloorPlan plan = SquarePlan();
  plan.solids = {{{1, 1}, {2, 1}, {2, 2}, {1, 2}}, {{2, 1.0005}, {3, 1.0005}, {3, 2}, {2, 2}}};
  EXPECT_EQ(ErrorOf([&] { MakeBuilding(plan); }),
            "plan.yaml:1: walls that do not quite meet leave a face of less than 0.001 m at "
            "(2, 1.0005)");
  plan.solids = {kSquare};
  EXPECT_EQ(ErrorOf([&] { MakeBuilding(plan); }),
            "plan.yaml:1: the building has no free space");
}

// Corners of none of these lie in the room, but the parts do.
TEST(Building, PartsMayReachThroughARoom) {
  const std::string path = WriteTestFile(
      "building.yaml",
      "floor_height_m: 0\nceiling_height_m: 3\n"
      "outlines: [{corners: [[0, 0], [4, 0], [4, 4], [0, 4]]}]\n"
      "walls: [{from: [-1, 2], to: [5, 2], thickness_m: 0.1}]\n"
      "furniture: [{kind: box, position: [4.4, 1], size_m: [1, 0.5, 1], yaw_deg: 45}]\n");
  EXPECT_EQ(ErrorOf([&] { ReadBuilding(path); }), "");
}

// Walls, cupboards and door openings meet along one outline but for rounding: without snapped
// corners CGAL's sweep ends in a segmentation fault here.
TEST(Building, CornersThatRoundingHoldsApartAreOne) {
  const std::string path = WriteTestFile("building.yaml", R"(
floor_height_m: 0.0
ceiling_height_m: 2.72
outlines:
  - {corners: [[0.0, 1.1], [19.52, 1.1], [19.52, 6.3], [0.0, 6.3]]}
solids:
  - {corners: [[0.0, 5.94], [3.4, 5.94], [3.4, 6.3], [0.0, 6.3]]}
  - {corners: [[11.36, 5.92], [15.0, 5.92], [15.0, 6.3], [11.36, 6.3]]}
walls:
  - from: [0.0, 1.1]
    to: [19.52, 1.1]
    thickness_m: 0.14
    openings:
      - {position_m: 2.64, width_m: 0.86, height_m: 2.1}
      - {position_m: 6.62, width_m: 0.94, height_m: 2.1}
      - {position_m: 9.24, width_m: 1.02, height_m: 2.1}
      - {position_m: 12.84, width_m: 1.0, height_m: 2.1}
      - {position_m: 18.1, width_m: 0.98, height_m: 2.1}
  - {from: [3.4, 1.1], to: [3.4, 6.3], thickness_m: 0.1}
  - {from: [7.54, 1.1], to: [7.54, 6.3], thickness_m: 0.1}
  - {from: [11.36, 1.1], to: [11.36, 6.3], thickness_m: 0.12}
)");
  const Building building = ReadBuilding(path);
  EXPECT_NEAR(TotalArea(FacesOn(building, {1, 0, 0}, 3.45)), 5.13 * 2.72, 1e-6);
}

TEST(Building, ErrorsNameFileAndLine) {
  const std::string head = "floor_height_m: 0\nceiling_height_m: 3\noutlines:\n";
  const std::string room = "  - corners: [[0, 0], [4, 0], [4, 4], [0, 4]]\n";
  const std::string wall = "walls:\n  - from: [0, 2]\n    to: [4, 2]\n    thickness_m: 0.1\n";
  const std::string door = "      - {position_m: 2, width_m: 1, height_m: 2}\n";
  const auto error = [&](const std::string& text) {
    const std::string path = WriteTestFile("building.yaml", text);
    const std::string message = ErrorOf([&] { ReadBuilding(path); });
    EXPECT_EQ(message.rfind(path + ":", 0), 0u) << message;
    return message.substr(std::min(path.size(), message.size()));
  };
  EXPECT_EQ(error(head + "  - corners: [[0, 0], [4, 0]]\n"),
            ":4: a polygon needs at least three corners");
  EXPECT_EQ(error(head + room + "  - corners: [[0, 0], [4, 4], [4, 0], [0, 4]]\n"),
            ":5: the polygon crosses or touches itself");
  EXPECT_EQ(error(head + "  []\n"), ":4: the building has no outline");
  EXPECT_EQ(error("floor_height_m: 3\nceiling_height_m: 3\noutlines:\n" + room),
            ":2: the ceiling must be above the floor");
  EXPECT_EQ(error(head + room + "colour: red\n"), ":5: unknown key 'colour'");
  EXPECT_EQ(error(head + room + "solids:\n  - corners: [[5, 0], [6, 0], [6, 1]]\n"),
            ":6: the solid stands in no room");
  EXPECT_EQ(
      error(head + room + "walls:\n  - {from: [-1, 4.1], to: [5, 4.1], thickness_m: 0.1}\n"),
      ":6: the wall stands in no room");
  EXPECT_EQ(error(head + room +
                  "furniture:\n  - {kind: box, position: [4.6, 2], size_m: [1, 1, 1]}\n"),
            ":6: the furniture stands in no room");
  EXPECT_EQ(error(head + room + wall + "    openings:\n" +
                  "      - {position_m: 3.6, width_m: 1, height_m: 2}\n"),
            ":10: the opening reaches beyond the end of its wall");
  EXPECT_EQ(error(head + room + wall + "    openings:\n" +
                  "      - {position_m: 2, width_m: 1, height_m: 3.5}\n"),
            ":10: the opening is higher than the ceiling");
  EXPECT_EQ(error(head + room + wall + "    openings:\n" + door + door),
            ":11: the opening overlaps another one of its wall");
  EXPECT_EQ(
      error(head + room + "walls:\n  - from: [1, 1]\n    to: [1, 1]\n    thickness_m: 1\n"),
      ":6: the wall is shorter than 0.01 m");
}

}  // namespace
}  // namespace plumbline
