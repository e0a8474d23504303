// Buildings whose walls bend.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

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
