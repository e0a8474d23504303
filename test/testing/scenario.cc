#include "test/testing/scenario.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/options/mapper_options.h"
#include "core/result/result_reader.h"
#include "core/util/partial_files.h"
#include "simulation/sensing/experiment.h"
#include "simulation/sensing/recording_writer.h"
#include "simulation/sensing/simulate_recording.h"
#include "simulation/sensing/simulator.h"
#include "test/testing/paths.h"

namespace plumbline {
namespace {

// The largest deviation of a normal variable that is not to be exceeded once in 100,000.
constexpr double kMaxSigmas = 4.5;
// Errors that remain of these paths without any noise: the spline can not follow them exactly.
constexpr double kRepresentation = 1e-3;     // m
constexpr double kRepresentationDeg = 0.02;  // of rotations and of planes' normals

std::string WalkText(const std::string& way_points, double length_m, double speed_m_s) {
  std::ostringstream text;
  text << "path:\n  way_points: [" << way_points
       << "]\n  closed: true\n  length_m: " << length_m
       << "\n  corner_radius_m: 0.5\n  body_height_m: 1.2\nspeed_m_s: " << speed_m_s << "\n";
  return text.str();
}

std::string RigText(const Scenario& scenario) {
  std::ostringstream text;
  text << "motion: " << scenario.motion_model << "\nscanners:\n";
  for (const ScenarioScanner& scanner : scenario.scanners) {
    text << "  - name: " << scanner.name << "\n    topic: /" << scanner.name
         << "\n    body_from_scanner:\n      translation: [" << scanner.translation
         << "]\n      rotation_rpy_deg: [" << scanner.rotation_deg
         << "]\n    range_noise_m: " << scanner.range_noise_m
         << "\n    min_range_m: 0.1\n    max_range_m: " << scanner.max_range_m
         << "\n    time_offset_s: " << scanner.time_offset_s
         << "\n    uncertainty: {rotation_deg: 0, translation_m: 0, time_s: 0, range_m: 0}"
         << "\n    beams: " << scanner.beams
         << "\n    field_of_view_deg: 270.0\n    scan_rate_hz: " << scanner.scan_rate_hz
         << "\n";
  }
  return text.str();
}

}  // namespace

std::string HexagonalRoom() {
  return "floor_height_m: 0.0\nceiling_height_m: 2.7\noutlines:\n"
         "  - corners: [[0.0, 0.0], [4.0, -1.2], [7.5, 0.5], [7.8, 4.2], [4.2, 6.0], [0.3, "
         "4.4]]\n";
}

std::string HexagonWalk(double length_m, double speed_m_s) {
  return WalkText("[1.5, 1.3], [4.2, 0.6], [6.2, 1.7], [6.1, 3.6], [4.0, 4.5], [1.6, 3.5]",
                  length_m,
                  speed_m_s);
}

std::string TrapezoidRoom() {
  return "floor_height_m: -0.5\nceiling_height_m: 2.1\noutlines:\n"
         "  - corners: [[0.0, 0.0], [9.0, 0.0], [6.5, 5.0], [1.5, 5.0]]\n";
}

std::string TrapezoidWalk(double length_m, double speed_m_s) {
  return WalkText("[2.0, 1.3], [6.8, 1.3], [5.6, 3.7], [2.6, 3.7]", length_m, speed_m_s);
}

std::string PillarRoom() {
  return "floor_height_m: 0.0\nceiling_height_m: 3.1\noutlines:\n"
         "  - corners: [[0.0, 0.0], [8.0, 0.6], [7.4, 6.4], [0.5, 5.5]]\n"
         "solids:\n"
         "  - corners: [[3.4, 2.6], [4.5, 2.5], [4.7, 3.6], [3.6, 3.8]]\n";
}

std::string PillarWalk(double length_m, double speed_m_s) {
  return WalkText("[1.8, 1.4], [6.2, 1.7], [6.0, 4.9], [2.0, 4.4]", length_m, speed_m_s);
}

std::vector<ScenarioScanner> TiltedRig() {
  return {{"level", "0.1, 0.0, 0.25", "0.0, 0.0, 30.0"},
          {"left", "-0.05, 0.2, 0.05", "0.0, 55.0, 60.0"},
          {"right", "-0.1, -0.15, -0.1", "0.0, -50.0, 110.0"}};
}

void MappingTest::SetUp() {
  TemporaryDirectoryTest::SetUp();
  FLAGS_minloglevel = google::ERROR;
}

SimulatedRecording MappingTest::Simulate(const Scenario& scenario, uint64_t seed) {
  WriteBytes(Path("building.yaml"), scenario.building);
  WriteBytes(Path("scenario_rig.yaml"), RigText(scenario));
  WriteBytes(
      Path("experiment.yaml"),
      "building: building.yaml\nrig: scenario_rig.yaml\n" + scenario.path + scenario.more);
  const Experiment experiment = ReadExperiment(Path("experiment.yaml"));
  const Simulator simulator(experiment);
  SimulatedRecording recording;
  recording.rig = experiment.rig;
  TruthPlanes truth_planes(experiment.building);
  simulator.Run([&](const PerfectScanLine& perfect) {
    const Scanner& scanner =
        experiment.rig.scanners[static_cast<size_t>(perfect.scan_line.scanner_index)];
    recording.scan_lines.push_back(AddNoise(perfect, scanner, experiment.noise, seed));
    truth_planes.Add(perfect, recording.scan_lines.back(), scanner.time_offset_s);
  });
  recording.truth_trajectory = TruthTrajectory(simulator.path());
  recording.truth_planes = truth_planes.Patches();
  return recording;
}

void MappingTest::WriteRecording(const SimulatedRecording& recording) {
  RecordingWriter writer(Path("recording.bag"), recording.rig);
  for (const ScanLine& scan_line : recording.scan_lines) writer.Write(scan_line);
  writer.Close();
  WriteRig(recording.rig, Path("rig.yaml"));
}

MapJob MappingTest::Job(const std::string& config, int threads) {
  MapJob job;
  job.recording = Path("recording.bag");
  job.rig = Path("rig.yaml");
  if (!config.empty()) {
    job.config = Path("config.yaml");
    WriteBytes(job.config, config);
  }
  job.output = Path("result");
  job.threads = threads;
  return job;
}

Summary MappingTest::Map(const std::string& config, int threads) {
  summary_ = RunMapJob(Job(config, threads), [](double) {});
  return summary_;
}

Evaluation MappingTest::EvaluateResult(const SimulatedRecording& recording) {
  EvaluationInput input;
  input.trajectory = ReadTrajectory(Path("result/trajectory.tum"));
  input.planes = ReadPlanes(Path("result/planes.json"));
  input.figures.motion = summary_.motion;
  input.figures.reference_plane_id = summary_.reference_plane_id;
  input.figures.residual_rms_m = summary_.residual_rms_m;
  input.figures.variance_factor = summary_.variance_factor;
  input.truth_trajectory = recording.truth_trajectory;
  input.truth_planes = recording.truth_planes;
  return Evaluate(input, {});
}

Evaluation MappingTest::Run(const Scenario& scenario, uint64_t seed) {
  const SimulatedRecording recording = Simulate(scenario, seed);
  WriteRecording(recording);
  Map(scenario.config);
  EXPECT_EQ(summary_.warnings, std::vector<std::string>());
  return EvaluateResult(recording);
}

Evaluation MappingTest::RunCase(const std::string& name, uint64_t seed) {
  SimulateRecording(ConfigsDir() + "/experiments/robustness/" + name + ".yaml",
                    seed,
                    directory_.string(),
                    [](double) {});
  Map();
  return Evaluate(ReadEvaluationInput(Path("result"), directory_.string()), {});
}

std::string MappingTest::MapError() {
  const std::string message = ErrorOf([this] { Map(); });
  EXPECT_NE(message, "no error");
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  if (std::filesystem::is_directory(Path("result"))) {
    EXPECT_TRUE(std::filesystem::is_empty(Path("result")));
  }
  for (const auto& entry : std::filesystem::directory_iterator(directory_)) {
    EXPECT_FALSE(IsPartialName(entry.path().filename().string(), "result")) << entry.path();
  }
  return message;
}

void ExpectTruePlanes(const Evaluation& evaluation) {
  SCOPED_TRACE(EvaluationTable(evaluation));
  const PlaneEvaluation& planes = evaluation.planes;
  EXPECT_EQ(planes.num_wrong, 0);
  EXPECT_EQ(planes.num_doubled, 0);
  EXPECT_EQ(planes.num_missed, 0);
  EXPECT_GT(planes.num_matched, 0);
  for (const PlaneMatch& match : planes.list) {
    EXPECT_LT(std::abs(match.distance_m),
              kMaxSigmas * match.sigma_distance_m + kRepresentation)
        << "plane " << match.plane_id;
    EXPECT_LT(match.angle_deg, kMaxSigmas * match.sigma_angle_deg + kRepresentationDeg)
        << "plane " << match.plane_id;
  }
}

PoseStddevs ExpectedPoseStddevs(double scan_rate_hz,
                                double range_noise_m,
                                const Summary& summary) {
  const TrajectoryOptions options;
  const double interval_s =
      std::max(options.knot_interval_s, options.min_scans_per_knot / scan_rate_hz);
  const double points_per_interval =
      static_cast<double>(summary.points_used) / summary.duration_s * interval_s;
  PoseStddevs stddevs;
  // Of six unknowns per interval three are the position; ranges see each direction at a third
  // of their number.
  stddevs.position_m = range_noise_m * std::sqrt(3.0 * 3.0 / points_per_interval);
  // Walls are 2 m away in these rooms: the same precision, seen as an angle.
  stddevs.rotation_deg = stddevs.position_m / 2.0 * 180.0 / M_PI;
  return stddevs;
}

void ExpectPreciseTrajectory(const Evaluation& evaluation,
                             const Scenario& scenario,
                             const Summary& summary) {
  SCOPED_TRACE(EvaluationTable(evaluation));
  double rate_hz = 0.0;
  double range_noise_m = 0.0;
  for (const ScenarioScanner& scanner : scenario.scanners) {
    rate_hz = std::max(rate_hz, scanner.scan_rate_hz);
    range_noise_m = std::max(range_noise_m, scanner.range_noise_m);
  }
  // Twice what is expected, for a geometry that is not ideal.
  const PoseStddevs stddevs = ExpectedPoseStddevs(rate_hz, range_noise_m, summary);
  EXPECT_LT(evaluation.trajectory.aligned.position_m.rmse,
            2.0 * stddevs.position_m + kRepresentation);
  EXPECT_LT(evaluation.trajectory.aligned.rotation_deg.rmse,
            2.0 * stddevs.rotation_deg + kRepresentationDeg);
  EXPECT_EQ(evaluation.trajectory.num_poses_uncovered, 0);
}

}  // namespace plumbline
