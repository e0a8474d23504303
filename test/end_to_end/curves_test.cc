// Buildings whose walls bend.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "core/result/ply_reader.h"
#include "core/result/result_reader.h"
#include "simulation/evaluation/evaluation.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

class CurvesTest : public MappingTest {
 protected:
  int NumCylinders() {
    int num_cylinders = 0;
    for (const PlanePatch& plane : ReadPlanes(Path("result/planes.json"))) {
      if (plane.type == PlaneType::kCylinder) ++num_cylinders;
    }
    return num_cylinders;
  }

  // The points of map.ply carry the unit normals of their surfaces.
  void ExpectNormalsOfSurfaces() {
    std::map<int, PlanePatch> planes;
    for (const PlanePatch& plane : ReadPlanes(Path("result/planes.json"))) {
      planes[plane.id] = plane;
    }
    PlyReader reader(Path("result/map.ply"));
    PointBuffer points;
    double largest_difference = 0.0;
    bool has_curved = false;
    while (reader.Next(&points)) {
      for (int64_t i = 0; i < points.num_points(); i += 97) {
        const MapPoint point = points.At(i);
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        if (point.plane_id >= 0) {
          const PlanePatch& plane = planes.at(point.plane_id);
          has_curved = has_curved || plane.IsCurved();
          normal = plane.NormalAt(point.p_world.cast<double>());
        }
        largest_difference = std::max(
            largest_difference, (normal - point.normal_world.cast<double>()).norm());
      }
    }
    EXPECT_LT(largest_difference, 1e-5);
    EXPECT_TRUE(has_curved);
  }
};

TEST_F(CurvesTest, ACurvedCorridorIsTwoCylinders) {
  const Evaluation evaluation = RunCase("curved_corridor", 5);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.rmse, 0.004);
  EXPECT_EQ(NumCylinders(), 2);
  EXPECT_EQ(evaluation.planes.num_wrong, 0);
  EXPECT_GT(evaluation.planes.completeness, 0.95);
  EXPECT_LT(evaluation.planes.radius_max_percent, 1.0);
  for (const PlaneMatch& match : evaluation.planes.list) {
    if (!match.radius_error_m) continue;
    EXPECT_LT(std::abs(*match.radius_error_m), 4.0 * match.sigma_radius_m);
  }
}

// Its heading hangs on two pillars while the door is out of sight.
TEST_F(CurvesTest, ARoundRoomIsOneCylinder) {
  const Evaluation evaluation = RunCase("round_room", 6);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.rmse, 0.004);
  EXPECT_EQ(NumCylinders(), 1);
  EXPECT_LT(evaluation.planes.radius_max_m, 0.01);
  ExpectNormalsOfSurfaces();
}

// A round room off a corridor, entered at one end and left there: between, three pillars
// beside the wall show the heading, and not to all scans.
Scenario WalkRoundTheRoom(const std::string& first_point, const std::string& last_point) {
  Scenario scenario;
  scenario.building = R"(
floor_height_m: 0.0
ceiling_height_m: 2.66
outlines:
  - {corners: [[0.0, -1.26], [10.1, -1.26], {through: [18.266, 0.0], to: [10.1, 1.26]}, [0.0, 1.26]]}
solids:
  - {corners: [[4.04, 0.96], [4.54, 0.96], [4.54, 1.36], [4.04, 1.36]]}
  - {corners: [[16.689, 2.409], [17.089, 2.409], [17.089, 2.809], [16.689, 2.809]]}
  - {corners: [[13.924, 3.63], [14.324, 3.63], [14.324, 4.03], [13.924, 4.03]]}
)";
  scenario.scanners = {{"top", "0, 0, 0.12", "0, 0, -90"},
                       {"left", "0, 0.1, 0", "0, 45, 45"},
                       {"right", "0, -0.1, 0", "0, -45, 135"}};
  for (ScenarioScanner& scanner : scenario.scanners) {
    scanner.beams = 270;
    scanner.scan_rate_hz = 40.0;
    scanner.range_noise_m = 0.03;
  }
  scenario.path = "path:\n  way_points: [" + first_point +
                  ", [10.1, 0.0], [11.661, -0.882], [14.086, -2.58], [16.666, 0.0], "
                  "[14.086, 2.58], [11.661, 0.882], " +
                  last_point + R"(]
  corner_radius_m: 0.4
  body_height_m: 1.46
  max_turn_rate_deg_s: 60
speed_m_s: 0.74)";
  scenario.more = R"(
motion:
  roll: {amplitude_deg: 1.2, frequency_hz: 0.94}
  pitch: {amplitude_deg: 2.92, frequency_hz: 1.26})";
  return scenario;
}

class RoundRoomTest : public CurvesTest {
 protected:
  // Warnings may come: it is about the map.
  Evaluation WalkFrom(const std::string& first_point,
                      const std::string& last_point,
                      int seed) {
    const SimulatedRecording recording =
        Simulate(WalkRoundTheRoom(first_point, last_point), static_cast<uint64_t>(seed));
    WriteRecording(recording);
    Map();
    return EvaluateResult(recording);
  }
};

TEST_F(RoundRoomTest, TheHeadingIsKeptWhereOnlyPillarsShowIt) {
  const Evaluation evaluation = WalkFrom("[4.6, 0.0]", "[9.0, 0.0]", 1);
  EXPECT_LT(evaluation.trajectory.aligned.rotation_deg.max, 0.5);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 0.03);
}

// Where it is lost all the same, the corridor is mapped a second time, and no wall shows that.
TEST_F(RoundRoomTest, AHeadingThatIsLostInARoundRoomIsSaid) {
  const Evaluation evaluation = WalkFrom("[8.6, 0.0]", "[9.6, 0.0]", 4);
  EXPECT_TRUE(evaluation.trajectory.aligned.rotation_deg.max < 0.5 ||
              summary_.consistency.verdict != Verdict::kConsistent);
}

// The column's chords are too short to show that they bend; its walls show it together.
TEST_F(CurvesTest, AnApseAndAColumnAreCylinders) {
  const Evaluation evaluation = RunCase("apse", 7);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.rmse, 0.003);
  EXPECT_EQ(NumCylinders(), 2);
  EXPECT_EQ(evaluation.planes.num_wrong, 0);
  EXPECT_LT(evaluation.planes.radius_max_m, 0.008);
}

}  // namespace
}  // namespace plumbline
