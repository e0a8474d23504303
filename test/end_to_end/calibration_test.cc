#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/geometry/angles.h"
#include "core/sensor/rig.h"
#include "factors/spline/so3.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

class CalibrationTest : public MappingTest {
 protected:
  // A walk once around a pillar, with a rig file that is wrong by 1 deg, 1 cm and 2 ms, of all
  // scanners but the body's, the first tilted one, and by 1 cm in one one's ranges.
  // times: so many times as wrong.
  void SimulateWithWrongRig(uint64_t seed, double times = 1.0) {
    Scenario scenario;
    scenario.building = PillarRoom();
    scenario.scanners = TiltedRig();
    for (ScenarioScanner& scanner : scenario.scanners) scanner.scan_rate_hz = 40.0;
    scenario.path = PillarWalk(10.0, 1.0);
    scenario.more =
        "motion:\n"
        "  roll: {amplitude_deg: 2.0, frequency_hz: 0.9, phase_deg: 20.0}\n"
        "  pitch: {amplitude_deg: 2.0, frequency_hz: 1.3, phase_deg: 110.0}\n";
    recording_ = Simulate(scenario, seed);
    WriteRecording(recording_);
    wrong_ = recording_.rig;
    const Eigen::Vector3d turns_deg[] = {{0.6, 0.0, 0.8}, {0.0, -0.8, -0.6}};
    const Eigen::Vector3d shifts_m[] = {{0.0, 0.01, 0.0}, {0.006, 0.0, -0.008}};
    for (size_t i = 0; i < 2; ++i) {
      Scanner& scanner = wrong_.scanners[2 * i];
      Rigid3d& pose = scanner.body_from_scanner;
      const Eigen::Vector3d turn = times * kRadiansPerDegree * turns_deg[i];
      pose.rotation = Exp(turn) * pose.rotation;
      pose.translation += times * shifts_m[i];
      scanner.time_offset_s += times * (i == 0 ? 0.002 : -0.002);
    }
    wrong_.scanners[2].range_bias_m = 0.01;
    for (Scanner& scanner : wrong_.scanners) {
      scanner.uncertainty = {kRadiansPerDegree, 0.01, 0.002, 0.01};
    }
    WriteRig(wrong_, Path("rig.yaml"));
  }

  void ExpectRightMap() {
    const Evaluation evaluation = EvaluateResult(recording_);
    EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
    EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 0.02);
    EXPECT_LT(evaluation.trajectory.aligned.rotation_deg.max, 0.5);
  }

  SimulatedRecording recording_;
  Rig wrong_;
};

TEST_F(CalibrationTest, MapOfAWrongRigFileIsRightAndSaysWhatTheRigIs) {
  SimulateWithWrongRig(7);
  Map();
  ExpectRightMap();
  const Rig found = ReadRig(Path("result/rig_calibrated.yaml"));
  for (size_t i = 0; i < 3; ++i) {
    const Scanner& scanner = found.scanners[i];
    const Scanner& truth = recording_.rig.scanners[i];
    const Eigen::Vector3d turn =
        Log(scanner.body_from_scanner.rotation * truth.body_from_scanner.rotation.conjugate());
    const Eigen::Vector3d shift =
        scanner.body_from_scanner.translation - truth.body_from_scanner.translation;
    // The largest of three axes each, four standard deviations.
    const ScannerUncertainty& sigma = scanner.uncertainty;
    EXPECT_LE(turn.cwiseAbs().maxCoeff(), 4.0 * sigma.rotation_rad + 1e-9) << i;
    EXPECT_LE(shift.cwiseAbs().maxCoeff(), 4.0 * sigma.translation_m + 1e-9) << i;
    EXPECT_LE(std::abs(scanner.time_offset_s - truth.time_offset_s), 4.0 * sigma.time_s + 1e-9)
        << i;
    EXPECT_LE(std::abs(scanner.range_bias_m), 4.0 * sigma.range_m) << i;
    EXPECT_LT(sigma.rotation_rad, 0.5 * kRadiansPerDegree);
    EXPECT_LT(sigma.time_s, 0.0005);
  }
}

// Scanners that see other places than the rig file says start where they agree, and the body's
// stays where it is stated.
TEST_F(CalibrationTest, ARigFileThatIsFarOffGivesTheSameMap) {
  SimulateWithWrongRig(7, 5.0);
  Map();
  ExpectRightMap();
  const Rig found = ReadRig(Path("result/rig_calibrated.yaml"));
  const size_t body = BodyScanner(wrong_);
  EXPECT_EQ(body, 1u);
  EXPECT_LT((found.scanners[body].body_from_scanner.translation -
             wrong_.scanners[body].body_from_scanner.translation)
                .norm(),
            1e-9);
  for (size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d turn =
        Log(found.scanners[i].body_from_scanner.rotation *
            recording_.rig.scanners[i].body_from_scanner.rotation.conjugate());
    EXPECT_LT(turn.norm(), 0.5 * kRadiansPerDegree) << i;
  }
}

TEST_F(CalibrationTest, CalibratedRigMapsTheRecordingAgain) {
  SimulateWithWrongRig(8);
  Map();
  std::filesystem::copy_file(Path("result/rig_calibrated.yaml"),
                             Path("rig.yaml"),
                             std::filesystem::copy_options::overwrite_existing);
  Map();
  const Evaluation evaluation = EvaluateResult(recording_);
  EXPECT_EQ(summary_.consistency.verdict, Verdict::kConsistent);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.max, 0.02);
}

TEST_F(CalibrationTest, ExactRigIsNotCalibrated) {
  SimulateWithWrongRig(9);
  WriteRig(recording_.rig, Path("rig.yaml"));
  Map();
  EXPECT_FALSE(std::filesystem::exists(Path("result/calibration.json")));
  EXPECT_FALSE(std::filesystem::exists(Path("result/rig_calibrated.yaml")));
}

}  // namespace
}  // namespace plumbline
