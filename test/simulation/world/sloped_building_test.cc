#include "simulation/world/sloped_building.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "simulation/world/ray_caster.h"
#include "test/testing/paths.h"
#include "test/testing/test_files.h"

namespace plumbline {
namespace {

const std::string kHead = "floor_height_m: 0\nceiling_height_m: 3\n";

Building Read(const std::string& text) {
  return ReadBuilding(WriteTestFile("building.yaml", text));
}

// Area of the faces with this normal and distance, and how many there are.
struct Found {
  int num = 0;
  double area = 0.0;
  PlaneType type = PlaneType::kVertical;
};

Found FacesOn(const Building& building, const Eigen::Vector3d& normal, double distance) {
  Found found;
  for (const Face& face : building.faces) {
    if ((face.normal - normal.normalized()).norm() > 1e-9) continue;
    if (std::abs(face.distance - distance) > 1e-9) continue;
    ++found.num;
    found.area += face.Area();
    found.type = face.type;
  }
  return found;
}

// A closed surface has no area as a vector, and no moment of it; all its normals look into
// the free space, whose volume is then as given. Outlines bound the triangles' areas.
void ExpectClosed(const Building& building, double volume) {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double enclosed = 0.0;
  for (const Face& face : building.faces) {
    EXPECT_EQ(face.id, &face - building.faces.data());
    Eigen::Vector3d of_triangles = Eigen::Vector3d::Zero();
    for (const auto& [a, b, c] : face.triangles) {
      const Eigen::Vector3d doubled = (b - a).cross(c - a);
      EXPECT_GT(doubled.norm(), 1e-9) << "face " << face.id;
      of_triangles += doubled / 2;
      enclosed -= a.dot(doubled) / 6;
      moment += ((a + b + c) / 3).cross(doubled) / 2;
    }
    Eigen::Vector3d of_outline = Eigen::Vector3d::Zero();
    std::vector<std::vector<Eigen::Vector3d>> loops = face.holes;
    loops.push_back(face.outline);
    for (const std::vector<Eigen::Vector3d>& loop : loops) {
      for (size_t i = 0; i < loop.size(); ++i) {
        of_outline += loop[i].cross(loop[(i + 1) % loop.size()]) / 2;
      }
    }
    EXPECT_LT((of_outline - of_triangles).norm(), 1e-6) << "face " << face.id;
    if (face.curvature == 0.0) {
      EXPECT_GT(of_triangles.dot(face.normal), 0.0) << "face " << face.id;
      EXPECT_LT(of_triangles.cross(face.normal).norm(), 1e-6) << "face " << face.id;
      for (const Eigen::Vector3d& corner : face.outline) {
        EXPECT_NEAR(face.normal.dot(corner), face.distance, 1e-6) << "face " << face.id;
      }
    }
    area += of_triangles;
  }
  EXPECT_LT(area.norm(), 1e-6);
  EXPECT_LT(moment.norm(), 1e-5);
  EXPECT_NEAR(enclosed, volume, 1e-5);
}

// Two halls of 4 x 4 m, the eastern one 1 m higher, and a ramp of 5 x 2 m between them.
const std::string kHallsAndRamp = kHead +
                                  "outlines:\n"
                                  "  - corners: [[0, 0], [4, 0], [4, 4], [0, 4]]\n"
                                  "  - corners: [[9, 0], [13, 0], [13, 4], [9, 4]]\n"
                                  "    floor_height_m: 1\n"
                                  "    ceiling_height_m: 4\n"
                                  "ramps:\n"
                                  "  - {from: [4, 2, 0], to: [9, 2, 1], width_m: 2}\n";

TEST(SlopedBuilding, RampJoinsHallsOfTwoHeights) {
  const Building building = Read(kHallsAndRamp);
  EXPECT_TRUE(building.is_closed);
  ExpectClosed(building, 2 * 4 * 4 * 3 + 5 * 2 * 3);
  const double slant = std::hypot(5.0, 1.0);
  const Found floor = FacesOn(building, {-1, 0, 5}, 5 * -0.8 / std::hypot(1.0, 5.0));
  EXPECT_EQ(floor.num, 1);
  EXPECT_EQ(floor.type, PlaneType::kGeneral);
  EXPECT_NEAR(floor.area, 2 * slant, 1e-9);
  const Found ceiling = FacesOn(building, {1, 0, -5}, -5 * (3 - 0.8) / std::hypot(1.0, 5.0));
  EXPECT_EQ(ceiling.num, 1);
  EXPECT_NEAR(ceiling.area, 2 * slant, 1e-9);
  EXPECT_NEAR(FacesOn(building, {0, 1, 0}, 1.0).area, 15.0, 1e-9);  // walls beside it
  EXPECT_NEAR(FacesOn(building, {0, -1, 0}, -3.0).area, 15.0, 1e-9);
  EXPECT_EQ(FacesOn(building, {-1, 0, 0}, -4.0).num, 2);  // the hall's, beside its mouth
  EXPECT_NEAR(FacesOn(building, {-1, 0, 0}, -4.0).area, 6.0, 1e-9);
  EXPECT_NEAR(FacesOn(building, {1, 0, 0}, 9.0).area, 6.0, 1e-9);
  EXPECT_EQ(building.faces.size(), 4u + 2u + 2u + 2u * 3u + 4u);
}

// A ramp in the middle of a hall, along its floor up to a bridge's end: a wedge whose sides
// are triangles and whose back is upright.
TEST(SlopedBuilding, RampInsideARoomHasSides) {
  const Building building = Read(kHead +
                                 "outlines:\n  - corners: [[0, 0], [8, 0], [8, 4], [0, 4]]\n"
                                 "ramps:\n  - {from: [2, 2, 0], to: [6, 2, 1], width_m: 1,\n"
                                 "     ceiling_height_m: 3}\n");
  ExpectClosed(building, 8 * 4 * 3 - 2);
  EXPECT_NEAR(FacesOn(building, {0, -1, 0}, -1.5).area, 2.0, 1e-9);
  EXPECT_NEAR(FacesOn(building, {0, 1, 0}, 2.5).area, 2.0, 1e-9);
  EXPECT_NEAR(FacesOn(building, {1, 0, 0}, 6.0).area, 1.0, 1e-9);
  EXPECT_NEAR(FacesOn(building, {0, 0, -1}, -3.0).area, 32.0, 1e-9);
  const Found floor = FacesOn(building, {0, 0, 1}, 0.0);
  EXPECT_EQ(floor.num, 1);
  EXPECT_NEAR(floor.area, 28.0, 1e-9);
  EXPECT_EQ(building.faces.size(), 6u + 1u + 3u);
}

// A roof of 45 degrees over 6 x 4 m, ridge along x at 3 m, cut off by a ceiling at 2.5 m, and
// a wall across below it.
TEST(SlopedBuilding, RoofCutsGablesAndWalls) {
  const std::string text =
      "floor_height_m: 0\nceiling_height_m: 2.5\n"
      "outlines:\n  - corners: [[0, 0], [6, 0], [6, 4], [0, 4]]\n"
      "roof:\n  - {ridge: [[0, 2], [6, 2]], height_m: 3, slope_deg: 45}\n";
  const double gable = 4 * 1.0 + 1.5 * (4 + 1) / 2;  // below 1 m, and a trapezoid up to 2.5 m
  const Building building = Read(text);
  ExpectClosed(building, 6 * gable);
  EXPECT_NEAR(FacesOn(building, {1, 0, 0}, 0.0).area, gable, 1e-9);
  EXPECT_NEAR(FacesOn(building, {-1, 0, 0}, -6.0).area, gable, 1e-9);
  EXPECT_NEAR(FacesOn(building, {0, 1, 0}, 0.0).area, 6.0, 1e-9);
  EXPECT_NEAR(
      FacesOn(building, {0, 1, -1}, -std::sqrt(0.5)).area, 6 * 1.5 * std::sqrt(2), 1e-9);
  EXPECT_NEAR(
      FacesOn(building, {0, -1, -1}, -5 * std::sqrt(0.5)).area, 6 * 1.5 * std::sqrt(2), 1e-9);
  EXPECT_NEAR(FacesOn(building, {0, 0, -1}, -2.5).area, 6.0, 1e-9);
  EXPECT_EQ(building.faces.size(), 8u);

  const Building with_wall =
      Read(text +
           "walls:\n  - {from: [3, 0], to: [3, 4], thickness_m: 0.2,\n"
           "     openings: [{position_m: 2, width_m: 1, height_m: 2}]}\n");
  ExpectClosed(with_wall, 5.8 * gable + 0.2 * 1 * 2);
  const Found side = FacesOn(with_wall, {1, 0, 0}, 3.1);
  EXPECT_EQ(side.num, 1);
  EXPECT_NEAR(side.area, gable - 2.0, 1e-9);
  EXPECT_NEAR(FacesOn(with_wall, {0, 0, -1}, -2.0).area, 0.2, 1e-9);  // the lintel

  // The same roof by its eaves.
  const Building by_eaves = Read(
      "floor_height_m: 0\nceiling_height_m: 2.5\n"
      "outlines:\n  - corners: [[0, 0], [6, 0], [6, 4], [0, 4]]\n"
      "roof:\n  - {eave: [[0, 0], [6, 0]], height_m: 1, slope_deg: 45}\n"
      "  - {eave: [[6, 4], [0, 4]], height_m: 1, slope_deg: 45}\n");
  ExpectClosed(by_eaves, 6 * gable);
  EXPECT_EQ(by_eaves.faces.size(), 8u);
}

// Two storeys of 6 x 3 m, 2.5 m high, a slab of 0.5 m with an opening, and a flight of six
// steps of 0.5 m through it.
std::string TwoStoreys(const std::string& thickness) {
  return "storeys:\n"
         "  - floor_height_m: 0\n    ceiling_height_m: 2.5\n"
         "    outlines:\n      - corners: [[0, 0], [6, 0], [6, 3], [0, 3]]\n"
         "    stairs:\n      - {from: [1, 0.5, 0], to: [4, 0.5, 3], width_m: 1, steps: 6" +
         thickness +
         "}\n"
         "  - floor_height_m: 3\n    ceiling_height_m: 5.5\n"
         "    outlines:\n      - corners: [[0, 0], [6, 0], [6, 3], [0, 3]]\n"
         "    floor_openings:\n      - corners: [[1, 0], [4, 0], [4, 1], [1, 1]]\n";
}

TEST(SlopedBuilding, StairsLeadThroughTheSlab) {
  const Building building = Read(TwoStoreys(""));
  // Each step is 0.5 m long and 1 m wide.
  const double flight = 0.5 * 0.5 * (1 + 2 + 3 + 4 + 5 + 6);
  ExpectClosed(building, 2 * 6 * 3 * 2.5 + 3 * 1 * 0.5 - flight);
  for (int i = 0; i < 5; ++i) {
    const Found tread = FacesOn(building, {0, 0, 1}, 0.5 * (i + 1));
    EXPECT_EQ(tread.num, 1);
    EXPECT_NEAR(tread.area, 0.5, 1e-9);
  }
  // The last one is a part of the upper floor.
  EXPECT_NEAR(FacesOn(building, {0, 0, 1}, 3.0).area, 18 - 2.5, 1e-9);
  EXPECT_EQ(FacesOn(building, {0, 0, 1}, 3.0).num, 1);
  for (int i = 1; i < 6; ++i) {
    EXPECT_NEAR(FacesOn(building, {-1, 0, 0}, -1 - 0.5 * i).area, 0.5, 1e-9) << i;
  }
  // The side of the flight, up to where the last step goes on into the slab.
  EXPECT_NEAR(FacesOn(building, {0, 1, 0}, 1.0).area, flight - 0.5 * 0.5, 1e-9);
  const RayCaster caster(building);
  const auto down = [&](double x, double y, double z) {
    const auto hit = caster.Cast({x, y, z}, {0, 0, -1});
    return hit ? hit->range : -1.0;
  };
  EXPECT_NEAR(down(2.25, 0.5, 4.0), 4.0 - 1.5, 1e-9);
  EXPECT_NEAR(down(2.25, 1.5, 4.0), 1.0, 1e-9);
}

TEST(SlopedBuilding, FlightOfStairsHasAnUnderside) {
  const Building building = Read(TwoStoreys(", thickness_m: 0.4"));
  // The flight's side: below the treads, less the triangle below the line 0.4 m under the
  // steps' edges, which is 2.6 m long and high.
  const double side = 0.5 * 0.5 * (1 + 2 + 3 + 4 + 5 + 6) - 2.6 * 2.6 / 2;
  ExpectClosed(building, 2 * 6 * 3 * 2.5 + 3 * 1 * 0.5 - side);
  const Found underside = FacesOn(building, {1, 0, -1}, 1.4 * std::sqrt(0.5));
  EXPECT_EQ(underside.num, 1);
  EXPECT_NEAR(underside.area, 2.6 * std::sqrt(2.0), 1e-9);
}

std::vector<Face> CylindersOf(const Building& building) {
  std::vector<Face> cylinders;
  for (const Face& face : building.faces) {
    if (face.type == PlaneType::kCylinder) cylinders.push_back(face);
  }
  return cylinders;
}

// Half a disc of 4 m radius whose floor rises along its diameter: the round wall is one face,
// and as high everywhere.
TEST(SlopedBuilding, ArcBesideARamp) {
  const Building building =
      Read(kHead +
           "outlines: [{corners: [[2, 2], [6, 2], [6, 4], [2, 4]]}]\n"
           "ramps:\n  - {from: [0, 4, 0], to: [8, 4, 1],\n"
           "     corners: [[0, 4], [8, 4], {through: [4, 8], to: [0, 4]}]}\n");
  const std::vector<Face> cylinders = CylindersOf(building);
  ASSERT_EQ(cylinders.size(), 1u);
  EXPECT_NEAR(cylinders[0].Area(), 4 * M_PI * 3, 1e-3);  // chords are shorter
  EXPECT_NEAR(cylinders[0].curvature, -0.25, 1e-12);
  EXPECT_NEAR((cylinders[0].middle - Eigen::Vector3d(4, 8, 2)).norm(), 0.0, 0.1);
  EXPECT_NEAR((cylinders[0].middle.head<2>() - Eigen::Vector2d(4, 4)).norm(), 4.0, 1e-9);
  double disc = 0.0;
  for (const Face& face : building.faces) {
    if (face.type == PlaneType::kGeneral && face.normal.z() > 0) disc = face.Area();
  }
  EXPECT_NEAR(disc, 8 * M_PI * std::hypot(8.0, 1.0) / 8, 2e-3);
  ExpectClosed(building, 3 * (disc * 8 / std::hypot(8.0, 1.0) + 8));
}

// The roof begins in the middle of a chord.
TEST(SlopedBuilding, RoofAcrossAnArc) {
  const Building sloped =
      Read(kHead +
           "outlines: [{corners: [[0, 4], [8, 4], {through: [4, 8], to: [0, 4]}]}]\n"
           "roof: [{eave: [[8, 0], [8, 8]], height_m: 1, slope_deg: 26.9}]\n");
  const std::vector<Face> cylinders = CylindersOf(sloped);
  ASSERT_EQ(cylinders.size(), 1u);
  EXPECT_LT(cylinders[0].Area(), 4 * M_PI * 3 - 1.0);
  EXPECT_NEAR(cylinders[0].normal.norm(), 1.0, 1e-9);
  // Volume: less a wedge of half the disc, whose height grows from x = 8 - 2 / tan(26.9 deg).
  const double slope = std::tan(26.9 * M_PI / 180);
  const double x0 = 8 - 2 / slope - 4;  // from the centre
  double wedge = 0.0;
  double area = 0.0;
  for (int i = 0; i < 40000; ++i) {
    const double x = -4 + (i + 0.5) * 8 / 40000;
    const double y = std::sqrt(16 - x * x);
    area += y * 8 / 40000;
    wedge += std::max(0.0, x - x0) * slope * y * 8 / 40000;
  }
  double volume = 0.0;
  for (const Face& face : sloped.faces) {
    for (const auto& [a, b, c] : face.triangles) volume -= a.dot((b - a).cross(c - a)) / 6;
  }
  EXPECT_NEAR(volume, 3 * area - wedge, 5e-3);  // chords
  ExpectClosed(sloped, volume);
}

// The middle of a face and its normal; of a cylinder, whose middle depends on where its first
// piece is, the axis and the curvature.
Eigen::Matrix<double, 6, 1> PlaceOf(const Face& face) {
  Eigen::Matrix<double, 6, 1> place;
  if (face.curvature == 0.0) {
    place << face.Centroid(), face.normal;
  } else {
    place << face.middle - face.normal / face.curvature, face.curvature, 0.0, 0.0;
  }
  return place;
}

// Two ways to the same faces.
TEST(SlopedBuilding, LevelBuildingsAreAsMakeBuildingMakesThem) {
  for (const std::string name : {"room", "corridor", "apse", "office"}) {
    const std::string path = ConfigsDir() + "/buildings/" + name + ".yaml";
    const std::vector<FloorPlan> plans = ReadFloorPlans(path);
    const Building expected = MakeBuilding(plans.front());
    const Building building = MakeSlopedBuilding(plans);
    ASSERT_EQ(building.faces.size(), expected.faces.size()) << name;
    for (const Face& face : expected.faces) {
      const auto same =
          std::find_if(building.faces.begin(), building.faces.end(), [&](const Face& other) {
            return other.type == face.type && std::abs(other.Area() - face.Area()) < 1e-6 &&
                   (PlaceOf(other) - PlaceOf(face)).norm() < 1e-6;
          });
      EXPECT_NE(same, building.faces.end()) << name << " face " << face.id;
    }
  }
}

// A roof that crosses walls, lintels and round walls at odd places.
TEST(SlopedBuilding, ARoofClosesOverAnyPlan) {
  for (const std::string name : {"office", "apse"}) {
    SCOPED_TRACE(name);
    const std::string path = ConfigsDir() + "/buildings/" + name + ".yaml";
    std::vector<FloorPlan> plans = ReadFloorPlans(path);
    const double flat = MakeSlopedBuilding(plans).faces.front().Area();
    plans.front().roofs = {{"", {{1.9, {0.02, -0.07}}, {2.4, {-0.05, 0.01}}}}};
    const Building building = MakeSlopedBuilding(plans);
    EXPECT_NEAR(building.faces.front().Area(), flat, 1e-6);
    double volume = 0.0;
    for (const Face& face : building.faces) {
      for (const auto& [a, b, c] : face.triangles) volume -= a.dot((b - a).cross(c - a)) / 6;
    }
    EXPECT_GT(volume, 0.0);
    ExpectClosed(building, volume);
  }
}

// The planes of the meshes that scripts/buildings/slopes.py makes, in single precision. Their
// pillars go through floor and roof, so that only some faces have the same areas.
void ExpectPlanesOf(const std::string& mesh, const Building& building) {
  const Building expected = ReadBuilding(ConfigsDir() + "/buildings/" + mesh + ".ply");
  for (const Face& face : building.faces) {
    const auto same =
        std::find_if(expected.faces.begin(), expected.faces.end(), [&](const Face& other) {
          return other.type == face.type && (other.normal - face.normal).norm() < 1e-6 &&
                 std::abs(other.distance - face.distance) < 1e-5;
        });
    ASSERT_NE(same, expected.faces.end()) << mesh << " face " << face.id;
    if (face.type == PlaneType::kGeneral && mesh == "halls_ramp") {
      EXPECT_NEAR(same->Area(), face.Area(), 1e-4);
    }
  }
}

TEST(SlopedBuilding, SlopesAreThoseOfTheMeshes) {
  ExpectPlanesOf("halls_ramp",
                 Read("floor_height_m: 0\nceiling_height_m: 2.8\n"
                      "outlines:\n  - corners: [[0, 0], [10, 0], [10, 8], [0, 8]]\n"
                      "  - corners: [[18, 0], [28, 0], [28, 8], [18, 8]]\n"
                      "    floor_height_m: 0.8\n    ceiling_height_m: 3.6\n"
                      "ramps:\n  - {from: [10, 4.3, 0], to: [18, 4.3, 0.8], width_m: 2.6}\n"
                      "solids:\n  - corners: [[4, 1.5], [4.5, 1.5], [4.5, 2], [4, 2]]\n"
                      "  - corners: [[24, 1.5], [24.5, 1.5], [24.5, 2.2], [24, 2.2]]\n"));
  ExpectPlanesOf("attic_35_deg",
                 Read("floor_height_m: 0\nceiling_height_m: 9\n"
                      "outlines:\n  - corners: [[0, 0], [16, 0], [16, 8], [0, 8]]\n"
                      "roof:\n  - {eave: [[0, 0], [16, 0]], height_m: 1.3, slope_deg: 35}\n"
                      "  - {eave: [[16, 8], [0, 8]], height_m: 1.3, slope_deg: 35}\n"
                      "solids:\n  - corners: [[5, 2], [5.4, 2], [5.4, 2.4], [5, 2.4]]\n"
                      "  - corners: [[8, -0.5], [8.2, -0.5], [8.2, 2.8], [8, 2.8]]\n"));
}

TEST(SlopedBuilding, ErrorsNameFileAndLine) {
  const auto error = [](const std::string& text) {
    const std::string path = WriteTestFile("building.yaml", text);
    const std::string message = ErrorOf([&] { ReadBuilding(path); });
    EXPECT_EQ(message.rfind(path + ":", 0), 0u) << message;
    return message.substr(std::min(path.size(), message.size()));
  };
  const std::string room =
      kHead + "outlines:\n  - corners: [[0, 0], [4, 0], [4, 4], [0, 4]]\n";
  EXPECT_EQ(error(room + "    floor_height_m: 3\n"),
            ":4: the ceiling must be above the floor");
  EXPECT_EQ(error(room + "ramps:\n  - {from: [1, 1, 0], to: [1, 1, 1], width_m: 1}\n"),
            ":6: the ramp is shorter than 0.01 m");
  EXPECT_EQ(error(room + "ramps:\n  - {from: [1, 1, 0], to: [2, 1, 1.5], width_m: 1}\n"),
            ":6: the ramp is steeper than 45 degrees");
  EXPECT_EQ(error(room + "ramps:\n  - {from: [1, 1, 0], to: [2, 1, 0.5]}\n"),
            ":6: a ramp has either a width or corners");
  EXPECT_EQ(error(room + "ramps:\n  - {from: [1, 1, 0], to: [2, 1, 0.5], width_m: 1,\n" +
                  "     ceiling_height_m: 0.5}\n"),
            ":6: the ceiling must be above the floor");
  EXPECT_EQ(
      error(room + "stairs:\n  - {from: [1, 1, 1], to: [3, 1, 0], width_m: 1, steps: 5}\n"),
      ":6: the stairs must rise, by 0.01 m a step or more");
  EXPECT_EQ(
      error(room + "stairs:\n  - {from: [1, 1, 0], to: [1, 1, 1], width_m: 1, steps: 5}\n"),
      ":6: the treads are shorter than 0.01 m");
  EXPECT_EQ(error(room + "roof:\n  - {height_m: 2, slope_deg: 10}\n"),
            ":6: a roof's plane has either an eave or a ridge");
  EXPECT_EQ(error(room + "roof:\n  - {eave: [[0, 0]], height_m: 2, slope_deg: 10}\n"),
            ":6: an eave or a ridge has two ends");
  EXPECT_EQ(error(room + "roof:\n  - {eave: [[0, 0], [0, 0]], height_m: 2, slope_deg: 10}\n"),
            ":6: the ends of an eave or a ridge must differ");
  EXPECT_EQ(error(room + "roof:\n  - {eave: [[0, 0], [4, 0]], height_m: -9, slope_deg: 10}\n"),
            ":1: the building has no free space");
  EXPECT_EQ(error(room + "floor_openings:\n  - corners: [[0, 0], [1, 0], [1, 1]]\n"),
            ":6: there is no storey below the lowest floor");
  EXPECT_EQ(error("storeys: []\n"), ":1: the building has no storey");
  const std::string upper =
      "  - floor_height_m: 3\n    ceiling_height_m: 5\n"
      "    outlines:\n      - corners: [[0, 0], [4, 0], [4, 4], [0, 4]]\n";
  EXPECT_EQ(error("storeys:\n" + upper + upper),
            ":6: storeys stand in their order from the lowest up");
  EXPECT_EQ(error("storeys:\n" + upper + "colour: red\n"), ":6: unknown key 'colour'");
}

// A part of the plan that would be left out without a word is an error.
TEST(SlopedBuilding, PartsThatChangeNothingAreErrors) {
  const auto error = [](const std::string& text) {
    const std::string path = WriteTestFile("building.yaml", text);
    const std::string message = ErrorOf([&] { ReadBuilding(path); });
    return message.substr(std::min(path.size(), message.size()));
  };
  const std::string room =
      kHead + "outlines:\n  - corners: [[0, 0], [4, 0], [4, 4], [0, 4]]\n";
  const std::string out_of_room =
      "stairs:\n  - {from: [5, 1, 0], to: [7, 1, 1], width_m: 1, steps: 5}\n";
  EXPECT_EQ(error(room + out_of_room), ":6: the stairs stand in no room");
  const std::string above_ceiling =
      "stairs:\n  - {from: [1, 1, 3], to: [3, 1, 4], width_m: 1, steps: 5}\n";
  EXPECT_EQ(error(room + above_ceiling), ":6: the stairs stand in no room");
  EXPECT_EQ(error(room + "roof:\n  - {ridge: [[0, 2], [4, 2]], height_m: 9, slope_deg: 10}\n"),
            ":6: the roof lies above all rooms of its storey");
  // One plane of a ridge that cuts is enough.
  EXPECT_EQ(error(room + "roof:\n  - {ridge: [[0, 0], [4, 0]], height_m: 3, slope_deg: 10}\n"),
            "");
  EXPECT_EQ(error(room + "ramps:\n  - {from: [4.1, 1, 0], to: [6, 1, 0.5], width_m: 1}\n"),
            ":6: the ramp touches no room");
  EXPECT_EQ(error(room + "ramps:\n  - {from: [4, 1, 0], to: [6, 1, 0.5], width_m: 1}\n"), "");
}

TEST(SlopedBuilding, FloorOpeningsLieAboveARoomAndBelowAnother) {
  const auto error = [](const std::string& opening) {
    const std::string path =
        WriteTestFile("building.yaml",
                      "storeys:\n"
                      "  - floor_height_m: 0\n    ceiling_height_m: 2\n"
                      "    outlines: [{corners: [[0, 0], [4, 0], [4, 4], [0, 4]]}]\n"
                      "  - floor_height_m: 3\n    ceiling_height_m: 5\n"
                      "    outlines: [{corners: [[2, 0], [8, 0], [8, 4], [2, 4]]}]\n"
                      "    floor_openings:\n"
                      "      - corners: [[3, 1], [3.5, 1], [3.5, 2], [3, 2]]\n"
                      "      - corners: " +
                          opening + "\n");
    const std::string message = ErrorOf([&] { ReadBuilding(path); });
    return message.substr(std::min(path.size(), message.size()));
  };
  const std::string expected =
      ":10: the floor opening lies nowhere above one room and below another";
  EXPECT_EQ(error("[[0.5, 1], [1.5, 1], [1.5, 2], [0.5, 2]]"), expected);  // no room above
  EXPECT_EQ(error("[[5, 1], [6, 1], [6, 2], [5, 2]]"), expected);          // none below
  EXPECT_EQ(error("[[9, 1], [10, 1], [10, 2], [9, 2]]"), expected);        // neither
  EXPECT_EQ(error("[[3.6, 1], [6, 1], [6, 2], [3.6, 2]]"), "");            // partly both
}

}  // namespace
}  // namespace plumbline
