#include <gtest/gtest.h>

#include <cmath>

#include "core/result/result_reader.h"
#include "core/result/result_writer.h"
#include "core/util/time.h"
#include "simulation/sensing/simulate_recording.h"
#include "test/testing/paths.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

using MappingMotionTest = MappingTest;

Scenario Base() {
  Scenario scenario;
  scenario.building = PillarRoom();
  scenario.scanners = TiltedRig();
  for (ScenarioScanner& scanner : scenario.scanners) scanner.scan_rate_hz = 40.0;
  scenario.path = PillarWalk(7.0, 1.0);
  return scenario;
}

TEST_F(MappingMotionTest, FollowsWobble) {
  Scenario scenario = Base();
  scenario.more =
      "motion:\n"
      "  roll: {amplitude_deg: 3.0, frequency_hz: 0.9, phase_deg: 40.0}\n"
      "  pitch: {amplitude_deg: 3.0, frequency_hz: 1.2, phase_deg: 110.0}\n"
      "  height: {amplitude_m: 0.03, frequency_hz: 1.5}\n";
  const Evaluation evaluation = Run(scenario);
  ExpectTruePlanes(evaluation);
  ExpectPreciseTrajectory(evaluation, scenario, summary_);
}

// A corner of 90 degrees that takes one second: 0.785 m of arc at 0.785 m/s.
TEST_F(MappingMotionTest, FollowsTurnOf90DegreesInOneSecond) {
  Scenario scenario = Base();
  scenario.path =
      "path:\n  way_points: [[1.6, 1.3], [6.4, 1.6], [6.1, 5.0]]\n  corner_radius_m: 0.5\n"
      "  body_height_m: 1.2\nspeed_m_s: 0.94\n";
  const Evaluation evaluation = Run(scenario);
  ExpectTruePlanes(evaluation);
  ExpectPreciseTrajectory(evaluation, scenario, summary_);
}

// Corners of 0.5 m radius at up to 200 deg/s, and a bend of 3.6 degrees taken within 35 ms: no
// spline with knots every 125 ms can follow. The trajectory may be off just there, as far as a
// spline that takes no notice of the bend; the rig must not be lost and no plane come of it.
TEST_F(MappingMotionTest, SurvivesFastTurnsAndAJolt) {
  SimulateRecording(
      ConfigsDir() + "/experiments/room.yaml", 1, directory_.string(), [](double) {});
  Map();
  const Evaluation evaluation =
      Evaluate(ReadEvaluationInput(Path("result"), directory_.string()), {});
  EXPECT_EQ(evaluation.planes.num_wrong, 0);
  EXPECT_EQ(evaluation.planes.num_doubled, 0);
  EXPECT_EQ(evaluation.planes.num_missed, 0);
  const PoseErrors& errors = evaluation.trajectory.unaligned;
  constexpr double kBendDeg = 3.6;
  EXPECT_LT(errors.rotation_deg.max, kBendDeg);
  // A control point has effect over four knot intervals: for so long, at 0.9 m/s, the rig goes
  // a way that the bend turns.
  EXPECT_LT(errors.position_m.max, 0.9 * 4.0 * 0.125 * std::sin(kBendDeg * M_PI / 180.0));
  // Half of the poses are those of straight stretches: twice what the noise of 3 cm at 40 Hz
  // lets expect there, as for all trajectories.
  EXPECT_LT(errors.rotation_deg.median,
            2.0 * ExpectedPoseStddevs(40.0, 0.03, summary_).rotation_deg);
}

Scenario PlanarBase() {
  Scenario scenario;
  scenario.building = PillarRoom();
  scenario.scanners = {{"front", "0.2, 0.0, 0.1", "0.0, 0.0, 0.0", 270, 20.0},
                       {"back", "-0.2, 0.1, 0.2", "0.0, 0.0, 170.0", 270, 20.0}};
  scenario.path = PillarWalk(8.0, 1.0);
  return scenario;
}

TEST_F(MappingMotionTest, FindsOutThatRigIsPlanar) {
  const Scenario scenario = PlanarBase();
  const Evaluation evaluation = Run(scenario);
  EXPECT_EQ(summary_.motion, "planar");
  ExpectTruePlanes(evaluation);
  ExpectPreciseTrajectory(evaluation, scenario, summary_);
  for (const PlanePatch& plane : ReadPlanes(Path("result/planes.json"))) {
    EXPECT_EQ(plane.type, PlaneType::kVertical);
  }
  for (const StampedPose& pose : ReadTrajectory(Path("result/trajectory.tum"))) {
    EXPECT_EQ(pose.world_from_body.translation.z(), 0.0);
    EXPECT_NEAR(pose.world_from_body.rotation.x(), 0.0, 1e-12);
    EXPECT_NEAR(pose.world_from_body.rotation.y(), 0.0, 1e-12);
  }
}

TEST_F(MappingMotionTest, MapsPlanarMotionWhereTold) {
  Scenario scenario = PlanarBase();
  scenario.motion_model = "planar";
  const Evaluation evaluation = Run(scenario);
  EXPECT_EQ(summary_.motion, "planar");
  ExpectTruePlanes(evaluation);
  ExpectPreciseTrajectory(evaluation, scenario, summary_);
}

}  // namespace
}  // namespace plumbline
