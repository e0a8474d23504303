// Buildings whose floors and ceilings slope.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/result/result_reader.h"
#include "simulation/evaluation/evaluation.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

class SlopesTest : public MappingTest {};

TEST_F(SlopesTest, ARampBetweenTwoHallsIsMapped) {
  const Evaluation evaluation = RunCase("halls_ramp", 5);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 0.01);
  EXPECT_LT(evaluation.trajectory.aligned.rotation_deg.max, 0.2);
  EXPECT_EQ(evaluation.planes.num_missed, 0);
  // Floor and ceiling of the ramp, of 5.7 degrees.
  int num_general = 0;
  for (const PlanePatch& plane : ReadPlanes(Path("result/planes.json"))) {
    if (plane.type != PlaneType::kGeneral) continue;
    ++num_general;
    EXPECT_NEAR(std::abs(plane.normal.z()), 8.0 / std::hypot(8.0, 0.8), 2e-4);
    EXPECT_GT(plane.sigma_angle_rad, 0.0);
  }
  EXPECT_EQ(num_general, 2);
}

// The level scanner sees the roof as it would see walls, from the first scan on.
TEST_F(SlopesTest, AnAtticIsMapped) {
  const Evaluation evaluation = RunCase("attic_35_deg", 6);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 0.01);
  EXPECT_EQ(evaluation.planes.num_wrong, 0);
}

// A floor plan with two general planes and a cylinder.
TEST_F(SlopesTest, ARampAndARoundBayAreMapped) {
  const Evaluation evaluation = RunCase("../ramp_and_arc", 5);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 0.02);
  EXPECT_EQ(evaluation.planes.num_missed, 0);
  EXPECT_EQ(evaluation.planes.num_wrong, 0);
  EXPECT_LT(evaluation.planes.radius_max_percent, 1.0);
  int num_general = 0;
  int num_cylinders = 0;
  for (const PlanePatch& plane : ReadPlanes(Path("result/planes.json"))) {
    num_general += plane.type == PlaneType::kGeneral;
    num_cylinders += plane.type == PlaneType::kCylinder;
  }
  EXPECT_EQ(num_general, 2);
  EXPECT_EQ(num_cylinders, 1);
}

TEST_F(SlopesTest, TwoStoreysAndTheirStairsAreMapped) {
  const Evaluation evaluation = RunCase("two_storeys", 5);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 0.02);
  // Both floors, 2.9 m apart.
  double lowest = 1e9;
  double highest = -1e9;
  for (const PlanePatch& plane : ReadPlanes(Path("result/planes.json"))) {
    if (plane.type != PlaneType::kHorizontal || plane.normal.z() < 0.0) continue;
    if (plane.sigma_distance_m > 0.02) continue;
    lowest = std::min(lowest, plane.distance);
    highest = std::max(highest, plane.distance);
  }
  EXPECT_NEAR(highest - lowest, 2.9, 0.02);
}

// A ramp of 1.4 degrees is taken for level, and the rig for turned while it is there.
TEST_F(SlopesTest, AGentleRampIsDoubtful) {
  RunCase("halls_gentle_ramp", 7);
  EXPECT_NE(summary_.consistency.verdict, Verdict::kConsistent);
}

}  // namespace
}  // namespace plumbline
